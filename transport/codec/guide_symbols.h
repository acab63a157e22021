#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace strandcast {

/// The 16-bit numbers that one chunk's guides are turned into, plane after plane.
struct GuideSymbols {
  int edge_planes = 3;          ///< 3: differences of positions, 2: octahedral coordinates, or tangents
  std::vector<uint16_t> roots;  ///< 3 planes of one per strand
  /// edge_planes planes of one per vertex that is not a root, strand by strand; of tangents pairs in place of
  /// two planes.
  std::vector<uint16_t> edges;
};

/// What is written of symbols: how far each is off a prediction, modulo 2^bits.
struct SymbolPrediction {
  bool along_strand = false;              ///< edges: from the edge before it
  int edge_bits = 16;                     ///< 12 or 16; roots always have 16
  std::span<const uint32_t> strand_ends;  ///< per strand, where its edges end in a plane; ascending
};

}  // namespace strandcast
