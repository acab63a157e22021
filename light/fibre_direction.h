#pragma once
#include <Eigen/Core>
#include <cmath>

#include "kernels/scalar_fibre.h"

namespace strandcast {

/// A unit vector in a fibre's frame (x: tangent): sine and cosine of its inclination theta, and its azimuth
/// as a unit vector (y, z), which is (1, 0) along the fibre.
struct FibreDirection {
  double sine, cosine, y, z;

  explicit FibreDirection(const Eigen::Vector3d& w) : sine(w.x()), cosine(std::hypot(w.y(), w.z())) {
    const bool across = cosine > 0;
    y = across ? w.y() / cosine : 1;
    z = across ? w.z() / cosine : 0;
  }
};

/// phi_o - phi_i, -pi to pi.
inline double azimuthBetween(const FibreDirection& o, const FibreDirection& i) {
  return kernels::f64::fibreAtan(o.z * i.y - o.y * i.z, o.y * i.y + o.z * i.z);
}

/// f grows as 1 / cos(theta_i); this least cosine keeps it finite along the fibre.
inline constexpr double kLeastCosine = 1e-9;

}  // namespace strandcast
