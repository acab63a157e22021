#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "core/strand_model.h"

namespace strandcast {

/// A hand that pulls hair: the vertices inside it when it closes keep their offsets from the hand wherever it
/// moves. Each is pulled by a critically damped spring, solved by implicit Euler for the end of a step, so
/// that no rate is too large for the step.
class HairPull {
 public:
  /// Closes about the free vertices within `radius` (m, 0 or more) of `from` (m, world), or about the nearest
  /// free vertex if there is none.
  HairPull(const StrandModel& model, std::span<const Vec3> positions, const Vec3& from, float radius);

  /// `to`: position of the hand, m, world; `rate`: of the spring, 1/s.
  void moveTo(const Vec3& to, float rate);
  /// Whether the hand was constructed with these values.
  bool closedAt(const Vec3& from, float radius) const { return from == from_ && radius == radius_; }
  /// Number of pulled vertices.
  size_t vertices() const { return held_.size(); }

  /// Adds the hand's accelerations over a step of `dt` seconds, m/s^2 per vertex of the model.
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
