#pragma once
#include <Eigen/Geometry>

#include "kernels/scalar_double.h"

namespace strandcast {

/// The elastic law of a joint (kernels/rod.h) in double precision and Eigen types, with its derivative.
/// Frames are unit quaternions. Strains, rest strains and stiffness (bending, bending, twist) are in the
/// inner frame.

inline kernels::f64::quat toLanes(const Eigen::Quaterniond& q) { return {q.x(), q.y(), q.z(), q.w()}; }
inline kernels::f64::real3 toLanes(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
inline Eigen::Vector3d fromLanes(const kernels::f64::real3& v) { return {v.x, v.y, v.z}; }

inline Eigen::Vector3d strainOfJoint(const Eigen::Quaterniond& inner, const Eigen::Quaterniond& outer) {
  return fromLanes(kernels::f64::jointStrain(toLanes(inner), toLanes(outer)));
}

/// Cosine of half the angle between the frames, clamped where the law is.
inline double cappedCosine(const Eigen::Quaterniond& inner, const Eigen::Quaterniond& outer) {
  return kernels::f64::cappedCosine(toLanes(inner.conjugate() * outer));
}

/// Matrix of the cross product with v on the left.
inline Eigen::Matrix3d crossMatrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

/// Derivative of a joint's moment, in the inner frame, by a small rotation eta of its outer frame: the sum of
/// both matrices. The strain u changes by T eta with T = 1 - [u]/2 + u u^T / 4, and the moment is c + u x
/// c / 2 with c = K (u - rest).
struct JointDerivative {
  Eigen::Matrix3d elastic;    ///< (K + [u] K / 2) T
  Eigen::Matrix3d geometric;  ///< -[c] T / 2
};
inline JointDerivative jointDerivative(const Eigen::Vector3d& u, const Eigen::Vector3d& c,
                                       const Eigen::Vector3d& stiffness) {
  const Eigen::Matrix3d half = 0.5 * crossMatrix(u);
  const Eigen::Matrix3d turn = Eigen::Matrix3d::Identity() - half + 0.25 * u * u.transpose();
  return {(Eigen::Matrix3d::Identity() + half) * stiffness.asDiagonal() * turn, -0.5 * crossMatrix(c) * turn};
}

}  // namespace strandcast
