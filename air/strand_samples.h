#pragma once
#include <array>
#include <vector>

#include "air/grid_passes.h"
#include "core/strand_model.h"

namespace strandcast {

/// How a strand is cut: whole edges, as equally many to a piece as it goes, or every edge into equal parts.
struct StrandPieces {
  uint32_t vertex;  ///< the first of the strand
  uint32_t edges;
  uint32_t sample;  ///< the first of the strand
  uint16_t pieces;  ///< in all; with more than one part, edges x parts
  uint16_t parts;   ///< of every edge; 1: pieces are whole edges

  /// Of piece p, counted from the strand's; of whole edges it ends where the next one begins.
  uint32_t firstEdge(uint32_t p) const { return parts > 1 ? p / parts : p * edges / pieces; }
};

/// The pieces of strands that stand for them on a grid: whole edges up to 1.5 cells long in all, or parts of
/// an edge that is longer. Pieces of a strand are neighbours, root to tip.
struct StrandSamples {
  std::vector<StrandSample> samples;
  std::vector<float> shares;          ///< of each sample's vertices in it, sum 1
  std::vector<StrandPieces> strands;  ///< per strand
  std::vector<uint32_t> offsets;      ///< strands + 1: first sample of each strand
  /// kg, per vertex: what the edge that starts there has at its start and at its end, 0 at tips.
  std::vector<std::array<float, 2>> edge_masses;
  /// Per entry of shares: the sample's mass at that vertex over the mass of the vertex. Its sum over all
  /// samples of a vertex is 1.
  std::vector<float> vertex_parts;
};

/// `cell` in metres.
StrandSamples strandSamples(const StrandModel& model, float cell);

}  // namespace strandcast
