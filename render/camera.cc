#include "render/camera.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace strandcast {

Camera orbit(const Box& box, float azimuth, float elevation, float zoom) {
  Camera camera;
  const bool usable = !box.isEmpty() && box.min().allFinite() && box.max().allFinite();
  Vec3 center = Vec3::Zero();
  if (usable) center = box.center();
  const float radius = usable ? std::max(0.5f * box.diagonal().norm(), 1e-3f) : 0.2f;
  const float distance = radius / std::sin(0.5f * camera.vertical_fov) / std::max(zoom, 0.05f);
  const Vec3 direction{std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                       std::cos(azimuth) * std::cos(elevation)};
  camera.target = center;
  camera.eye = Vec3(camera.target + distance * direction);
  camera.up = Vec3(-std::sin(azimuth) * std::sin(elevation), std::cos(elevation),
                   -std::cos(azimuth) * std::sin(elevation));
  return camera;
}

Eigen::Matrix4f viewMatrix(const Vec3& eye, const Vec3& target, const Vec3& wanted_up) {
  Vec3 back = eye - target;
  back = back.norm() > 1e-9f ? Vec3(back.normalized()) : Vec3(Vec3::UnitZ());
  Vec3 right = wanted_up.cross(back);
  if (!(right.norm() > 0.0447f * wanted_up.norm()))  // less than 2.5 degrees (tangent) from the view axis
    right = (std::abs(back.z()) < 0.9f ? Vec3(Vec3::UnitZ()) : Vec3(Vec3::UnitY())).cross(back);
  right.normalize();
  Eigen::Matrix4f view = Eigen::Matrix4f::Identity();
  view.block<1, 3>(0, 0) = right.transpose();
  view.block<1, 3>(1, 0) = back.cross(right).transpose();
  view.block<1, 3>(2, 0) = back.transpose();
  view.block<3, 1>(0, 3) = -view.block<3, 3>(0, 0) * eye;
  return view;
}

Eigen::Matrix4f viewMatrix(const Camera& camera) { return viewMatrix(camera.eye, camera.target, camera.up); }

Eigen::Matrix4f perspective(float vertical_fov, float aspect, float near_plane, float far_plane) {
  const float focal = 1 / std::tan(0.5f * vertical_fov);
  Eigen::Matrix4f projection = Eigen::Matrix4f::Zero();
  projection(0, 0) = focal / aspect;
  projection(1, 1) = focal;
  projection(2, 2) = (far_plane + near_plane) / (near_plane - far_plane);
  projection(2, 3) = 2 * far_plane * near_plane / (near_plane - far_plane);
  projection(3, 2) = -1;
  return projection;
}

std::optional<PicturePoint> projected(const Camera& camera, const Vec3& point, float aspect) {
  const Eigen::Vector4f eye = viewMatrix(camera) * Eigen::Vector4f(point.x(), point.y(), point.z(), 1);
  if (!(eye.z() < -1e-4f)) return std::nullopt;
  const float focal = 1 / std::tan(0.5f * camera.vertical_fov);
  return PicturePoint{0.5f + 0.5f * focal / aspect * eye.x() / -eye.z(),
                      0.5f - 0.5f * focal * eye.y() / -eye.z(), aspect};
}

float heightsInPicture(const Camera& camera, const Box& box) {
  const float radius = 0.5f * box.diagonal().norm(), distance = (box.center() - camera.eye).norm();
  if (!(distance > radius)) return std::numeric_limits<float>::infinity();
  const float tangent = radius / std::sqrt(distance * distance - radius * radius);
  return tangent / std::tan(0.5f * camera.vertical_fov);
}

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
