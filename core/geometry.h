// Public API
// Vectors, rotations, poses and triangle meshes.
#pragma once
#include <Eigen/Geometry>

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

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

/// Throws Error, naming `where`, unless the position is finite and within kFarthestPose of the origin on each
/// axis and the rotation is a unit quaternion to kUnitTolerance. Allocates only to throw.
void checkPose(const Pose& pose, const char* where);

constexpr float kFarthestPose = 1e4f;    ///< m: beyond it a float does not resolve a millimetre
constexpr float kUnitTolerance = 1e-3f;  ///< on a rotation's norm

/// Rotation nearest to a matrix of finite numbers.
Quat nearestRotation(const Eigen::Matrix3d& matrix);

/// A triangle mesh in metres, Y up, counter-clockwise seen from outside.
struct TriangleMesh {
  std::string name;
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;                       ///< one per position, unit length; empty until computed
  std::vector<std::array<uint32_t, 3>> triangles;  ///< indices into positions, all in range

  bool empty() const { return triangles.empty(); }
  Box bounds() const {
    Box box;
    for (const Vec3& p : positions) box.extend(Eigen::Vector3f(p));
    return box;
  }
};

/// Sets `normals` to the angle-weighted mean of the adjacent triangles' normals.
void computeNormals(TriangleMesh& mesh);

}  // namespace strandcast
