#include "core/measure.h"

#include <algorithm>
#include <cmath>

namespace strandcast {

Measurement measure(const StrandModel& model, std::span<const Vec3> positions,
                    std::span<const MovingPrimitive> primitives, std::span<const uint32_t> words) {
  Measurement out;
  double sum = 0;
  size_t edges = 0;
  for (size_t s = 0; s < model.strands(); ++s) {
    for (uint32_t v = model.offsets[s]; v < model.offsets[s + 1]; ++v) {
      if (!positions[v].allFinite()) {
        ++out.non_finite;
        continue;
      }
      if (v > model.offsets[s]) {
        const float rest = (model.rest_local[v] - model.rest_local[v - 1]).norm();
        const double stretch = std::fabs((positions[v] - positions[v - 1]).norm() / rest - 1.0);
        sum += stretch;
        ++edges;
        out.max_stretch = std::max(out.max_stretch, stretch);
      }
      if (model.isPinned(s, v)) continue;
      const double allowed = model.rest_distance.empty() ? 0 : std::min(0.0f, model.rest_distance[v]);
      for (const MovingPrimitive& primitive : primitives)
        out.max_penetration =
            std::max<double>(out.max_penetration, allowed - signedDistance(primitive, positions[v], words));
    }
  }
  out.mean_stretch = edges > 0 ? sum / static_cast<double>(edges) : 0;
  return out;
}

}  // namespace strandcast
