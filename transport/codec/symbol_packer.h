#pragma once
#include <zstd.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "transport/codec/guide_symbols.h"
#include "transport/codec/strand_coder.h"

namespace strandcast {

/// Bytes of two sections (low bytes, high bytes) behind their lengths.
class SymbolPacker {
 public:
  explicit SymbolPacker(const StrandCoder& coder);
  /// Whether predicting edges from the edge before costs fewer bits, by a sample; whatever `prediction` says
  /// of it.
  static bool prefersAlongStrand(const GuideSymbols& symbols, const SymbolPrediction& prediction);
  /// Appends to `bytes`; allocates only while its memory grows.
  void pack(const GuideSymbols& symbols, const SymbolPrediction& prediction, std::vector<uint8_t>& bytes);

 private:
  void foldEdges(const GuideSymbols& symbols, const SymbolPrediction& prediction, size_t roots);
  struct Free {
    void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
  };
  const decltype(StrandCoder::fold) fold_;
  std::unique_ptr<ZSTD_CCtx, Free> context_;
  std::vector<uint8_t> low_, high_;
};

class SymbolUnpacker {
 public:
  explicit SymbolUnpacker(const StrandCoder& coder);
  /// Into `symbols`, whose planes have the lengths that are expected; edges as residuals, before they are
  /// added up along the strand. False on bytes that are damaged, or hold more or fewer symbols than that;
  /// `symbols` is arbitrary then.
  bool unpack(std::span<const uint8_t> bytes, GuideSymbols& symbols);

 private:
  struct Free {
    void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
  };
  const decltype(StrandCoder::unfold) unfold_;
  std::unique_ptr<ZSTD_DCtx, Free> context_;
  std::vector<uint8_t> low_, high_;
};

}  // namespace strandcast
