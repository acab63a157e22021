// Elasticity of a strand in double precision: law of a joint, stiffness and mass of sections.
#pragma once
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/material.h"
#include "kernels/scalar_strands.h"

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

/// Mass and stiffness of a strand of a material, integrated over intervals of its length. Positions are in
/// metres from the root. Joints and vertices represent the interval around them, not a point: otherwise the
/// position of a step in a curve would be known only to an edge's length.
class RodSections {
 public:
  RodSections(const Material& material, double length) : material_(material), length_(length) {
    for (const RootTipCurve* curve :
         {&material.radius_scale, &material.stiffness_scale, &material.density_scale})
      for (const auto& [place, factor] : curve->knots) knots_.push_back(static_cast<double>(place) * length);
    std::sort(knots_.begin(), knots_.end());
  }

  /// Mass of an interval, kg.
  double mass(double from, double to) const {
    return material_.density * (to - from) *
           mean(from, to, [&](float place) { return material_.density_scale.at(place) * area(place); });
  }
  /// Bending stiffness of an interval, N m^2: the harmonic mean, because a constant moment causes curvature
  /// in proportion to 1 / stiffness.
  double bendingStiffness(double from, double to) const {
    return 1 / mean(from, to, [&](float place) {
             const double a = area(place), second_moment = a * a / (4 * kPi);
             return 1 / (material_.youngs_modulus * material_.stiffness_scale.at(place) * second_moment);
           });
  }

 private:
  static constexpr double kPi = 3.14159265358979323846;

  /// Area of the cross section, m^2. `place`: 0 (root) to 1 (tip).
  double area(float place) const {
    const double r = material_.radius * material_.radius_scale.at(place);
    return kPi * r * r;
  }
  /// Mean of a function over an interval. Curves are linear between knots; each such piece uses
  /// Gauss-Legendre quadrature with three points.
  template <class Function>
  double mean(double from, double to, const Function& function) const {
    const double outer = std::sqrt(0.6);
    double sum = 0;
    auto add = [&](double begin, double end) {
      if (!(end > begin)) return;
      const double middle = 0.5 * (begin + end), half = 0.5 * (end - begin);
      auto at = [&](double place) { return function(static_cast<float>(place / length_)); };
      sum += (end - begin) / 18 *
             (5 * at(middle - outer * half) + 8 * at(middle) + 5 * at(middle + outer * half));
    };
    double begin = from;
    for (const double knot : knots_)
      if (knot > begin && knot < to) {
        add(begin, knot);
        begin = knot;
      }
    add(begin, to);
    return sum / (to - from);
  }

  const Material& material_;
  double length_;
  std::vector<double> knots_;  ///< m from the root, of all curves
};

}  // namespace strandcast
