#pragma once
#include <zstd.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace strandcast {

/// The 16-bit numbers that one chunk's guides are turned into, plane after plane.
struct GuideSymbols {
  int edge_planes = 3;          ///< 3: differences of positions, 2: octahedral coordinates
  std::vector<uint16_t> roots;  ///< 3 planes of one per strand
  std::vector<uint16_t> edges;  ///< edge_planes planes of one per vertex that is not a root, strand by strand
};

/// How symbols become bytes: each is predicted, the residual taken modulo 2^bits and folded to small numbers
/// (zigzag), low and high bytes are put apart and compressed with zstd.
struct SymbolPrediction {
  bool along_strand = false;              ///< edges: from the edge before it
  int edge_bits = 16;                     ///< 12 or 16; roots always have 16
  std::span<const uint32_t> strand_ends;  ///< per strand, where its edges end in a plane; ascending
};

/// Bytes of two sections (low bytes, high bytes) behind their lengths.
class SymbolPacker {
 public:
  SymbolPacker();
  /// Whether predicting edges from the edge before costs fewer bits, by a sample; whatever `prediction` says
  /// of it.
  static bool prefersAlongStrand(const GuideSymbols& symbols, const SymbolPrediction& prediction);
  /// Appends to `bytes`; allocates only while its memory grows.
  void pack(const GuideSymbols& symbols, const SymbolPrediction& prediction, std::vector<uint8_t>& bytes);

 private:
  struct Free {
    void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
  };
  std::unique_ptr<ZSTD_CCtx, Free> context_;
  std::vector<uint16_t> residuals_;
  std::vector<uint8_t> plane_;
};

class SymbolUnpacker {
 public:
  SymbolUnpacker();
  /// Into `symbols`, whose planes have the lengths that are expected. False on bytes that are damaged, or
  /// hold more or fewer symbols than that; `symbols` is arbitrary then.
  bool unpack(std::span<const uint8_t> bytes, const SymbolPrediction& prediction, GuideSymbols& symbols);

 private:
  struct Free {
    void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
  };
  std::unique_ptr<ZSTD_DCtx, Free> context_;
  std::vector<uint8_t> low_, high_;
};

}  // namespace strandcast
