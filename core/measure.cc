#include "core/measure.h"

#include <algorithm>
#include <cmath>

namespace strandcast {

void Measurement::add(const Measurement& other) {
  const auto own = static_cast<double>(edges), theirs = static_cast<double>(other.edges);
  if (other.edges > 0) mean_stretch = (own * mean_stretch + theirs * other.mean_stretch) / (own + theirs);
  max_stretch = std::max(max_stretch, other.max_stretch);
  max_penetration = std::max(max_penetration, other.max_penetration);
  non_finite += other.non_finite;
  edges += other.edges;
}

namespace {

/// Maximum of `most` and the depth of any free vertex of these strands below the surface of one body, m.
double deepest(const StrandModel& model, std::span<const Vec3> positions, const MovingPrimitive& body,
               std::span<const uint32_t> words, StrandRange strands, double most) {
  const Box box = sweptBox(body);
  for (size_t s = strands.begin; s < strands.end; ++s)
    for (uint32_t v = model.offsets[s]; v < model.offsets[s + 1]; ++v) {
      if (!box.contains(Eigen::Vector3f(positions[v])) || model.isPinned(s, v)) continue;
      const double allowed = model.rest_distance.empty() ? 0 : std::min(0.0f, model.rest_distance[v]);
      most = std::max<double>(most, allowed - signedDistance(body, positions[v], words));
    }
  return most;
}

}  // namespace

Measurement measure(const StrandModel& model, std::span<const Vec3> positions,
                    std::span<const MovingPrimitive> primitives, std::span<const uint32_t> words,
                    StrandRange strands) {
  strands.end = std::min(strands.end, model.strands());
  Measurement out;
  double sum = 0;
  for (size_t s = strands.begin; s < strands.end; ++s) {
    bool inner_is_finite = false;
    for (uint32_t v = model.offsets[s]; v < model.offsets[s + 1]; ++v) {
      const bool is_finite = positions[v].allFinite(), has_length = is_finite && inner_is_finite;
      inner_is_finite = is_finite;
      if (!is_finite) ++out.non_finite;
      if (!has_length) continue;
      const float rest = (model.rest_local[v] - model.rest_local[v - 1]).norm();
      const double stretch = std::fabs((positions[v] - positions[v - 1]).norm() / rest - 1.0);
      sum += stretch;
      ++out.edges;
      out.max_stretch = std::max(out.max_stretch, stretch);
    }
  }
  for (const MovingPrimitive& body : primitives)
    out.max_penetration = deepest(model, positions, body, words, strands, out.max_penetration);
  out.mean_stretch = out.edges > 0 ? sum / static_cast<double>(out.edges) : 0;
  return out;
}

}  // namespace strandcast
