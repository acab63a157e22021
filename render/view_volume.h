#pragma once
#include <Eigen/Core>
#include <array>
#include <span>

#include "core/geometry.h"

namespace strandcast {

/// What a picture, or the eye of a light, can show: six planes (Gribb and Hartmann 2001).
class ViewVolume {
 public:
  explicit ViewVolume(const Eigen::Matrix4f& view_projection);
  /// Whether the hull of these points is outside one of the planes; may say no of what is outside all the
  /// same.
  bool misses(std::span<const Eigen::Vector3f> points) const;

 private:
  std::array<Eigen::Vector4f, 6> planes_;  ///< inside where plane . (x, 1) is 0 or more
};

using BoxCorners = std::array<Eigen::Vector3f, 8>;
BoxCorners cornersOf(const Box& box);

}  // namespace strandcast
