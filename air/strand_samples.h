#pragma once
#include <array>
#include <vector>

#include "air/grid_passes.h"
#include "core/strand_model.h"

namespace strandcast {

/// How a strand is cut into pieces: several whole edges per piece, distributed evenly, or each edge into
/// equal parts.
struct StrandPieces {
  uint32_t vertex;  ///< first vertex of the strand
  uint32_t edges;
  uint32_t sample;  ///< first sample of the strand
  uint16_t pieces;  ///< of the strand; edges x parts where parts > 1
  uint16_t parts;   ///< parts per edge; 1: pieces consist of whole edges

  /// First edge of piece p, relative to the strand's first edge. A piece of whole edges ends where piece p +
  /// 1 begins.
  uint32_t firstEdge(uint32_t p) const { return parts > 1 ? p / parts : p * edges / pieces; }
};

/// Samples that represent strands on a grid, one per piece: whole edges with a total length of up to 1.5
/// cells, or parts of a longer edge. The samples of a strand are contiguous, root to tip.
struct StrandSamples {
  std::vector<StrandSample> samples;
  std::vector<float> shares;          ///< weights of a sample's vertices, sum 1 per sample
  std::vector<StrandPieces> strands;  ///< per strand
  std::vector<uint32_t> offsets;      ///< strands + 1: first sample of each strand
  /// kg, per vertex: masses at the start and at the end of the edge that starts there; 0 at tips.
  std::vector<std::array<float, 2>> edge_masses;
  /// Per entry of `shares`: the sample's mass at that vertex over the mass of the vertex. The sum over all
  /// samples of a vertex is 1.
  std::vector<float> vertex_parts;
};

/// `cell` in metres.
StrandSamples strandSamples(const StrandModel& model, float cell);

}  // namespace strandcast
