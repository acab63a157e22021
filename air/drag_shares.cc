#include "air/drag_shares.h"

#include <algorithm>

namespace strandcast {

DragShares dragShares(const StrandModel& model, const StrandSamples& samples) {
  DragShares out;
  const std::vector<float>& scale = model.air_drag_scale;
  if (std::all_of(scale.begin(), scale.end(), [](float factor) { return factor == 1; })) return out;
  double mass = 0, dragged = 0;
  for (const StrandPieces& strand : samples.strands)
    for (uint32_t p = 0; p < strand.pieces; ++p) {
      // All parts of an edge have the factor of the edge.
      const uint32_t first = strand.firstEdge(p),
                     end = strand.parts > 1 ? first + 1 : strand.firstEdge(p + 1);
      double own = 0, own_dragged = 0;
      for (uint32_t v = strand.vertex + first; v < strand.vertex + end; ++v)
        for (size_t side = 0; side < 2; ++side) {
          own += double{samples.edge_masses[v][side]};
          own_dragged += double{samples.edge_masses[v][side]} * double{scale[v + side]};
        }
      const double factor = own_dragged / own;
      out.of_samples.push_back(static_cast<float>(factor));
      const double of_sample = double{samples.samples[strand.sample + p].mass};
      mass += of_sample;
      dragged += of_sample * factor;
    }
  out.mean = mass > 0 ? dragged / mass : 1;
  for (float& share : out.of_samples) share = out.mean > 0 ? static_cast<float>(share / out.mean) : 0.0f;
  return out;
}

}  // namespace strandcast
