#include "render/view_volume.h"

#include <algorithm>

namespace strandcast {

ViewVolume::ViewVolume(const Eigen::Matrix4f& view_projection) {
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side)
      planes_[static_cast<size_t>(2 * axis + side)] =
          view_projection.row(3).transpose() +
          (side == 0 ? 1.0f : -1.0f) * view_projection.row(axis).transpose();
}

bool ViewVolume::misses(std::span<const Eigen::Vector3f> points) const {
  return std::any_of(planes_.begin(), planes_.end(), [&](const Eigen::Vector4f& plane) {
    return std::all_of(points.begin(), points.end(),
                       [&](const Eigen::Vector3f& p) { return plane.head<3>().dot(p) + plane.w() < 0; });
  });
}

BoxCorners cornersOf(const Box& box) {
  BoxCorners corners;
  for (int i = 0; i < 8; ++i) corners[static_cast<size_t>(i)] = box.corner(static_cast<Box::CornerType>(i));
  return corners;
}

}  // namespace strandcast
