#include "core/hair_pull.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"

namespace strandcast {

void checkPull(const Vec3& from, float radius, const Vec3& to, float rate) {
  const auto is_place = [](const Vec3& place) {
    return place.allFinite() && place.cwiseAbs().maxCoeff() <= kMaxHandCoordinate;
  };
  const bool sound =
      is_place(from) && is_place(to) && radius >= 0 && radius <= 10 && rate >= 0 && rate <= 1000;
  if (!sound)
    throw Error("a pull is out of range",
                fmt::format("from {} {} {} to {} {} {}, radius {} m, rate {} 1/s", from.x(), from.y(),
                            from.z(), to.x(), to.y(), to.z(), radius, rate),
                "give places within 1000 m, a radius of 0 to 10 m and a rate of 0 to 1000 1/s");
}

HairPull::HairPull(const StrandModel& model, std::span<const Vec3> positions, const Vec3& from, float radius)
    : from_(from), radius_(radius), accelerations_(model.vertices()) {
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

std::span<const Vec3> HairPull::accelerations(std::span<const Vec3> others, std::span<const Vec3> positions,
                                              std::span<const Vec3> velocities, float dt) {
  if (others.empty())
    std::fill(accelerations_.begin(), accelerations_.end(), Vec3::Zero());
  else
    std::copy(others.begin(), others.end(), accelerations_.begin());
  // v' = v + dt a, x' = x + dt v', and a = rate^2 (target - x') - 2 rate v'.
  const float scale = 1 / (1 + 2 * rate_ * dt + rate_ * rate_ * dt * dt);
  for (const Held& held : held_) {
    const Vec3& v = velocities[held.vertex];
    const Vec3 ahead = held.place + way_ - positions[held.vertex] - dt * v;
    accelerations_[held.vertex] += scale * (rate_ * rate_ * ahead - 2 * rate_ * v);
  }
  return accelerations_;
}

}  // namespace strandcast
