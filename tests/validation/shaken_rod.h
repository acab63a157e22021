#pragma once
#include <cmath>
#include <numbers>
#include <vector>

#include "core/parameters.h"
#include "validation/specimen.h"

namespace strandcast {

/// Shared by the tests of motion: parameters of the rod solver and a curl.

inline Parameters rodParameters(double rate, double drag) {
  Parameters parameters;
  parameters.solver = SolverKind::kRod;
  parameters.time_step = static_cast<float>(1 / rate);
  parameters.substeps = 1;
  parameters.air_drag = static_cast<float>(drag);
  return parameters;
}

/// A helix downwards from the root with a pitch of 1 cm, m; a straight strand where the radius is 0.
inline std::vector<Vec3> hungCurl(double length, int edges, double radius) {
  const double rise = 0.01 / (2 * std::numbers::pi);  // per radian
  std::vector<Vec3> points;
  for (int i = 0; i <= edges; ++i) {
    const double s = length * i / edges, a = s / std::hypot(radius, rise);
    const Eigen::Vector3d curled(radius * (std::cos(a) - 1), -rise * a, radius * std::sin(a));
    points.push_back((radius > 0 ? curled : Eigen::Vector3d(0, -s, 0)).cast<float>());
  }
  return points;
}

}  // namespace strandcast
