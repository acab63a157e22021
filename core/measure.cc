#include "core/measure.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace strandcast {

void Measurement::add(const Measurement& other) {
  const auto own = static_cast<double>(edges), theirs = static_cast<double>(other.edges);
  if (other.edges > 0) mean_stretch = (own * mean_stretch + theirs * other.mean_stretch) / (own + theirs);
  max_stretch = std::max(max_stretch, other.max_stretch);
  max_penetration = std::max(max_penetration, other.max_penetration);
  non_finite += other.non_finite;
  edges += other.edges;
}

Measurement measure(const StrandModel& model, std::span<const Vec3> positions,
                    std::span<const MovingPrimitive> primitives, std::span<const uint32_t> words,
                    StrandRange strands) {
  std::vector<Box> boxes(primitives.size());
  std::transform(primitives.begin(), primitives.end(), boxes.begin(), sweptBox);
  Measurement out;
  double sum = 0;
  for (size_t s = strands.begin; s < std::min(strands.end, model.strands()); ++s) {
    for (uint32_t v = model.offsets[s]; v < model.offsets[s + 1]; ++v) {
      if (!positions[v].allFinite()) {
        ++out.non_finite;
        continue;
      }
      if (v > model.offsets[s]) {
        const float rest = (model.rest_local[v] - model.rest_local[v - 1]).norm();
        const double stretch = std::fabs((positions[v] - positions[v - 1]).norm() / rest - 1.0);
        sum += stretch;
        ++out.edges;
        out.max_stretch = std::max(out.max_stretch, stretch);
      }
      if (model.isPinned(s, v)) continue;
      const double allowed = model.rest_distance.empty() ? 0 : std::min(0.0f, model.rest_distance[v]);
      for (size_t p = 0; p < primitives.size(); ++p)
        if (boxes[p].contains(Eigen::Vector3f(positions[v])))
          out.max_penetration = std::max<double>(
              out.max_penetration, allowed - signedDistance(primitives[p], positions[v], words));
    }
  }
  out.mean_stretch = out.edges > 0 ? sum / static_cast<double>(out.edges) : 0;
  return out;
}

}  // namespace strandcast
