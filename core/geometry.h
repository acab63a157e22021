#pragma once
#include <Eigen/Geometry>
#include <cmath>

namespace strandcast {

/// SI units, Y up, right-handed. Positions in metres. Quaternions rotate local to world.
using Vec2 = Eigen::Vector2f;
using Vec3 = Eigen::Matrix<float, 3, 1, Eigen::DontAlign>;
using Quat = Eigen::Quaternion<float, Eigen::DontAlign>;
using Box = Eigen::AlignedBox3f;

/// A rigid placement: x_world = rotation * x_local + position.
struct Pose {
  Vec3 position = Vec3::Zero();
  Quat rotation = Quat::Identity();

  Vec3 apply(const Vec3& local) const { return rotation * local + position; }
  Vec3 rotate(const Vec3& local) const { return rotation * local; }
  Pose operator*(const Pose& child) const { return {apply(child.position), rotation * child.rotation}; }
  Pose inverse() const {
    const Quat back = rotation.conjugate();
    return {back * -position, back};
  }
};

/// Interpolates two poses, t in [0, 1]: positions linearly, rotations by slerp.
inline Pose interpolate(const Pose& a, const Pose& b, float t) {
  return {a.position + t * (b.position - a.position), a.rotation.slerp(t, b.rotation)};
}

/// Shortest rotation from the unit vector `from` to the unit vector `to`; half a turn about some
/// perpendicular axis if they are opposite.
template <class Scalar>
Eigen::Quaternion<Scalar> shortestRotation(const Eigen::Matrix<Scalar, 3, 1>& from,
                                           const Eigen::Matrix<Scalar, 3, 1>& to) {
  Eigen::Matrix<Scalar, 3, 1> axis = from.cross(to);
  const Scalar sine = axis.norm();
  const Scalar angle = std::atan2(sine, from.dot(to));
  axis = sine > Scalar(1e-12) ? (axis / sine).eval() : from.unitOrthogonal().eval();
  return Eigen::Quaternion<Scalar>(Eigen::AngleAxis<Scalar>(angle, axis));
}

}  // namespace strandcast
