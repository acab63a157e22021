#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "core/strand_model.h"

namespace strandcast {

/// Bound on each coordinate of a hand, m.
constexpr float kMaxHandCoordinate = 1000;

/// Throws Error if a number of a pull is out of range or not finite. `from` and `to`: m, world, each
/// coordinate within kMaxHandCoordinate; `radius`: 0 to 10 m; `rate`: 0 to 1000 1/s.
void checkPull(const Vec3& from, float radius, const Vec3& to, float rate);

/// A hand that pulls hair: the vertices inside it when it closes keep their offsets from the hand wherever it
/// moves. Each is pulled by a critically damped spring, solved by implicit Euler for the end of a step, so
/// that no rate is too large for the step.
class HairPull {
 public:
  /// Closes about the free vertices within `radius` (m, 0 or more) of `from` (m, world), or about the nearest
  /// free vertex if there is none. `positions`: m, world, one per vertex of the model.
  HairPull(const StrandModel& model, std::span<const Vec3> positions, const Vec3& from, float radius);

  /// `to`: position of the hand, m, world; `rate`: of the spring, 1/s.
  void moveTo(const Vec3& to, float rate);
  /// Whether the hand was constructed with these values.
  bool closedAt(const Vec3& from, float radius) const { return from == from_ && radius == radius_; }
  /// Number of pulled vertices.
  size_t vertices() const { return held_.size(); }

  /// Accelerations over a step of `dt` seconds, m/s^2 per vertex of the model: those of the hand and `others`
  /// together. `others`: one per vertex; empty = none. `positions`: m, world; `velocities`: m/s. The result
  /// is valid until the next call. Does not allocate.
  std::span<const Vec3> accelerations(std::span<const Vec3> others, std::span<const Vec3> positions,
                                      std::span<const Vec3> velocities, float dt);

 private:
  struct Held {
    uint32_t vertex;
    Vec3 place;  ///< m, world, when the hand closed
  };
  std::vector<Held> held_;
  Vec3 from_, way_ = Vec3::Zero();
  float radius_, rate_ = 0;
  std::vector<Vec3> accelerations_;  ///< m/s^2, one per vertex of the model
};

}  // namespace strandcast
