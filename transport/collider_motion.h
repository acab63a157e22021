#pragma once
#include <span>
#include <vector>

#include "transport/messages.h"

namespace strandcast {

/// Extrapolates poses of colliders for a frame that lacks them: along their last motion in the world, with
/// their last bends.
class ColliderMotion {
 public:
  void clear();
  /// Records the colliders of a frame; time: simulation time, s.
  void learn(std::span<const PlacedCollider> placed, double time);
  /// `out`: all colliders of the last frame that had poses.
  void extrapolate(double time, std::vector<PlacedCollider>& out) const;

 private:
  std::vector<PlacedCollider> last_, before_;
  double last_time_ = 0, before_time_ = 0;  // s
};

}  // namespace strandcast
