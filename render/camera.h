#pragma once
#include <Eigen/Core>

#include <array>
#include <optional>
#include <span>

#include "core/geometry.h"

namespace strandcast {

/// A perspective camera, in world space.
struct Camera {
  Vec3 eye{0.35f, 0.1f, 0.9f};  ///< m
  Vec3 target{0, -0.08f, 0};    ///< m
  float vertical_fov = 0.6f;    ///< rad
  Vec3 up{0, 1, 0};             ///< up direction of the picture, any length
};

/// Orbits `box`. Azimuth, rad: 0 looks at the face (towards -Z), growing towards +X. Elevation, rad, above
/// the horizon, up to straight above, where the azimuth rotates the picture. At zoom 1 the box's bounding
/// sphere fills the picture's height; larger is nearer.
Camera orbit(const Box& box, float azimuth, float elevation, float zoom);

/// World to eye space: the eye looks along -Z with Y up. Where `up` is parallel to the view, another
/// direction is chosen.
Eigen::Matrix4f viewMatrix(const Vec3& eye, const Vec3& target, const Vec3& up = Vec3::UnitY());
Eigen::Matrix4f viewMatrix(const Camera& camera);
/// Eye to clip space, OpenGL depth range -1 to 1.
Eigen::Matrix4f perspective(float vertical_fov, float aspect, float near_plane, float far_plane);

/// A position in the picture, 0 to 1 from the left and from the top, and the picture's aspect, width over
/// height.
struct PicturePoint {
  float x, y, aspect;
};

/// Projects a point of the world into the picture; empty behind the camera.
std::optional<PicturePoint> projected(const Camera& camera, const Vec3& point, float aspect);

/// Diameter of the bounding sphere of `box` in heights of the picture, wherever in the picture it is;
/// infinite where the eye is in the sphere.
float heightsInPicture(const Camera& camera, const Box& box);

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
