#pragma once
#include "air/grid_passes.h"
#include "core/strand_model.h"

namespace strandcast {

/// The pieces of strands that stand for them on a grid: whole edges up to 1.5 cells long in all, or parts of
/// an edge that is longer. Pieces of a strand are neighbours, root to tip.
struct StrandSamples {
  std::vector<StrandSample> samples;
  std::vector<float> shares;      ///< of each sample's vertices in it, sum 1
  std::vector<uint32_t> offsets;  ///< strands + 1: first sample of each strand
  /// Per entry of shares: the sample's mass at that vertex over the mass of the vertex. Its sum over all
  /// samples of a vertex is 1.
  std::vector<float> vertex_parts;
};

/// `cell` in metres.
StrandSamples strandSamples(const StrandModel& model, float cell);

}  // namespace strandcast
