#pragma once
#include <span>

#include "core/geometry.h"

namespace strandcast {

/// Where hair may be: within a kilometre of the groom's middle, along each axis, as the head carries it. What
/// a damaged frame has farther out widens no box.
class HairPlace {
 public:
  HairPlace() = default;  ///< of a groom about the origin
  explicit HairPlace(std::span<const Vec3> rest);

  void carryTo(const Pose& head) { middle_ = head.rotation.normalized() * rest_middle_ + head.position; }
  bool holds(const Vec3& position) const;

 private:
  Vec3 rest_middle_ = Vec3::Zero(), middle_ = Vec3::Zero();
};

}  // namespace strandcast
