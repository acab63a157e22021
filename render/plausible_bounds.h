#pragma once
#include <span>

#include "core/geometry.h"

namespace strandcast {

/// The box of plausible hair positions: within 1000 m of the groom's median position along each axis, carried
/// by the head. Received positions outside it do not enlarge bounding boxes.
class PlausibleBounds {
 public:
  PlausibleBounds() = default;  ///< of a groom about the origin
  explicit PlausibleBounds(std::span<const Vec3> rest);

  void carryTo(const Pose& head) { middle_ = head.rotation.normalized() * rest_middle_ + head.position; }
  bool holds(const Vec3& position) const;

 private:
  Vec3 rest_middle_ = Vec3::Zero(), middle_ = Vec3::Zero();
};

}  // namespace strandcast
