#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace strandcast {

/// The 16-bit symbols of one chunk's guides, plane after plane.
struct GuideSymbols {
  int edge_planes = 3;          ///< 3: differences of positions; 2: octahedral coordinates or tangent steps
  std::vector<uint16_t> roots;  ///< 3 planes (x, y, z) with one symbol per strand
  /// edge_planes planes with one symbol per vertex that is not a root, strand by strand. Tangent steps are
  /// not planes but pairs (u, v) per vertex.
  std::vector<uint16_t> edges;
};

/// How symbols become residuals: differences to a prediction, modulo 2^bits.
struct SymbolPrediction {
  bool along_strand = false;              ///< edges: predicted from the edge before
  int edge_bits = 16;                     ///< 12 or 16; roots always have 16
  std::span<const uint32_t> strand_ends;  ///< per strand, the end of its edges within a plane; ascending
};

}  // namespace strandcast
