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

/// Symbols as blocks of bits; or two sections, low and high bytes, compressed with zstd, behind their
/// lengths.
class SymbolPacker {
 public:
  explicit SymbolPacker(const StrandCoder& coder);
  /// Whether predicting edges from the edge before costs fewer bits, by a sample; whatever `prediction` says
  /// of it.
  static bool prefersAlongStrand(const GuideSymbols& symbols, const SymbolPrediction& prediction);
  /// Both append to `bytes`; they allocate only while memory grows.
  void packInBlocks(const GuideSymbols& symbols, const SymbolPrediction& prediction,
                    std::vector<uint8_t>& bytes);
  void compress(const GuideSymbols& symbols, const SymbolPrediction& prediction, std::vector<uint8_t>& bytes);

 private:
  /// Of edges; what `symbols` has, or residuals_.
  std::span<const uint16_t> residualsOf(const GuideSymbols& symbols, const SymbolPrediction& prediction);
  struct Free {
    void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
  };
  const decltype(StrandCoder::pack) pack_;
  const decltype(StrandCoder::subtract) subtract_;
  const decltype(StrandCoder::fold) fold_;
  std::unique_ptr<ZSTD_CCtx, Free> context_;
  std::vector<uint16_t> residuals_;
  std::vector<uint8_t> low_, high_;
};

class SymbolUnpacker {
 public:
  explicit SymbolUnpacker(const StrandCoder& coder);
  /// Both read into `symbols`, whose planes have the lengths that are expected; edges as residuals, before
  /// they are added up along the strand. False on bytes that are damaged, or hold more or fewer symbols than
  /// that; `symbols` is arbitrary then.
  bool unpackBlocks(std::span<const uint8_t> bytes, GuideSymbols& symbols) const;
  bool decompress(std::span<const uint8_t> bytes, GuideSymbols& symbols);

 private:
  struct Free {
    void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
  };
  const decltype(StrandCoder::unpack) unpack_;
  const decltype(StrandCoder::unfold) unfold_;
  std::unique_ptr<ZSTD_DCtx, Free> context_;
  std::vector<uint8_t> low_, high_;
};

}  // namespace strandcast
