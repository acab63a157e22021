#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "core/strand_model.h"

namespace strandcast {

/// A hand in the hair: the vertices that it closed about are drawn to the same places about the hand wherever
/// it goes. Free vertices would follow as by a critically damped spring, solved by implicit Euler for the end
/// of a step, so that no rate is too large for the step.
class HairPull {
 public:
  /// Closes about the vertices within `radius` (m, 0 or more) of `from` (m, world), or the nearest one where
  /// there are none; pinned ones stay out.
  HairPull(const StrandModel& model, std::span<const Vec3> positions, const Vec3& from, float radius);

  /// `to`: where the hand is, m, world; `rate`: of the spring, 1/s.
  void moveTo(const Vec3& to, float rate);
  bool closedAt(const Vec3& from, float radius) const { return from == from_ && radius == radius_; }
  size_t vertices() const { return held_.size(); }

  /// Adds what the hand gives over a step of `dt` seconds, m/s^2 per vertex of the model.
  void addTo(std::span<Vec3> accelerations, std::span<const Vec3> positions, std::span<const Vec3> velocities,
             float dt) const;

 private:
  struct Held {
    uint32_t vertex;
    Vec3 place;  ///< m, world, when the hand closed
  };
  std::vector<Held> held_;
  Vec3 from_, way_ = Vec3::Zero();
  float radius_, rate_ = 0;
};

}  // namespace strandcast
