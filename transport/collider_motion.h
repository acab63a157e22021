#pragma once
#include <span>
#include <vector>

#include "transport/messages.h"

namespace strandcast {

/// Where colliders probably are in a frame that does not tell: carried on along their last motion in the
/// world, as bent as they were last.
class ColliderMotion {
 public:
  void clear();
  void learn(std::span<const PlacedCollider> placed, double time);
  /// `out`: all that were placed last.
  void carryOn(double time, std::vector<PlacedCollider>& out) const;

 private:
  std::vector<PlacedCollider> last_, before_;
  double last_time_ = 0, before_time_ = 0;  // s
};

}  // namespace strandcast
