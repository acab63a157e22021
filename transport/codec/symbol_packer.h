#pragma once
#include <zstd.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "transport/codec/guide_payload.h"
#include "transport/codec/strand_coder.h"

namespace strandcast {

/// Packs symbols either as blocks of bits, or as two sections (low bytes, high bytes), each compressed with
/// zstd and preceded by its length.
class SymbolPacker {
 public:
  explicit SymbolPacker(const StrandCoder& coder);
  /// Whether prediction from the edge before costs fewer bits, estimated from a sample. Ignores
  /// prediction.along_strand.
  static bool prefersAlongStrand(const GuideSymbols& symbols, const SymbolPrediction& prediction);
  /// Both append to `bytes`; they allocate only while capacities grow.
  void packInBlocks(const GuideSymbols& symbols, const SymbolPrediction& prediction,
                    std::vector<uint8_t>& bytes);
  void compress(const GuideSymbols& symbols, const SymbolPrediction& prediction, std::vector<uint8_t>& bytes);

 private:
  /// Residuals of the edges: a view of `symbols` or of residuals_.
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

/// Inverse of SymbolPacker, for bytes that are not trusted.
class SymbolUnpacker {
 public:
  explicit SymbolUnpacker(const StrandCoder& coder);
  /// Both read into `symbols`, whose planes must have the expected lengths. Edges are residuals, not yet
  /// summed along the strand. False on damaged bytes, or on more or fewer symbols than expected; the content
  /// of `symbols` is unspecified then.
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
