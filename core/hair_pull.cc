#include "core/hair_pull.h"

namespace strandcast {

HairPull::HairPull(const StrandModel& model, std::span<const Vec3> positions, const Vec3& from, float radius)
    : from_(from), radius_(radius) {
  Held nearest{0, Vec3::Zero()};
  float least = -1;
  for (size_t s = 0; s < model.strands(); ++s) {
    for (uint32_t v = model.offsets[s]; v < model.offsets[s + 1]; ++v) {
      if (model.isPinned(s, v)) continue;
      const float distance = (positions[v] - from).norm();
      if (distance <= radius) held_.push_back({v, positions[v]});
      if (least >= 0 && !(distance < least)) continue;
      least = distance;
      nearest = {v, positions[v]};
    }
  }
  if (held_.empty() && least >= 0) held_.push_back(nearest);
}

void HairPull::moveTo(const Vec3& to, float rate) {
  way_ = to - from_;
  rate_ = rate;
}

void HairPull::addTo(std::span<Vec3> accelerations, std::span<const Vec3> positions,
                     std::span<const Vec3> velocities, float dt) const {
  // v' = v + dt a, x' = x + dt v', and a = rate^2 (target - x') - 2 rate v'.
  const float scale = 1 / (1 + 2 * rate_ * dt + rate_ * rate_ * dt * dt);
  for (const Held& held : held_) {
    const Vec3& v = velocities[held.vertex];
    const Vec3 ahead = held.place + way_ - positions[held.vertex] - dt * v;
    accelerations[held.vertex] += scale * (rate_ * rate_ * ahead - 2 * rate_ * v);
  }
}

}  // namespace strandcast
