#pragma once
#include <Eigen/Core>
#include <array>
#include <span>

#include "core/geometry.h"

namespace strandcast {

/// The view frustum of a camera or light as six planes (Gribb and Hartmann 2001).
class ViewVolume {
 public:
  /// `view_projection`: world to clip space.
  explicit ViewVolume(const Eigen::Matrix4f& view_projection);
  /// Whether the hull of these points is entirely outside one of the planes. Conservative: may return false
  /// for points outside the frustum.
  bool misses(std::span<const Eigen::Vector3f> points) const;

 private:
  std::array<Eigen::Vector4f, 6> planes_;  ///< inside where plane . (x, 1) >= 0
};

using BoxCorners = std::array<Eigen::Vector3f, 8>;
BoxCorners cornersOf(const Box& box);

}  // namespace strandcast
