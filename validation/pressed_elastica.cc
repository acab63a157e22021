#include "validation/pressed_elastica.h"

#include <Eigen/Dense>
#include <cmath>

#include "core/error.h"
#include "validation/runge_kutta.h"

namespace strandcast {
namespace {

using State = Eigen::Vector4d;  // angle from the vertical, its derivative, position sideways, position down

// theta'' = -N sin theta - T cos theta over the length from the clamp. `forces`: theta'(0), N, T.
State alongRod(const Eigen::Vector3d& forces, double length) {
  constexpr int kSteps = 400;
  State y(0, forces[0], 0, 0);
  for (int i = 0; i < kSteps; ++i)
    y = rungeKuttaStep(length * i / kSteps, y, length / kSteps, [&](double, const State& at) {
      return State(at[1], -forces[1] * std::sin(at[0]) - forces[2] * std::cos(at[0]), std::sin(at[0]),
                   std::cos(at[0]));
    });
  return y;
}

Eigen::Vector3d missed(const Eigen::Vector3d& forces, double height) {
  const State tip = alongRod(forces, 1);
  return {tip[1], tip[2], tip[3] - height};
}

}  // namespace

PressedElastica pressedElastica(double shortening, int edges) {
  // Start of the continuation: the first buckling mode of a clamped-hinged column, tan k = k.
  constexpr double kBuckling = 4.493409457909064, kStep = 0.0025;
  const double first = std::min(shortening, kStep);
  const double size = 2 * std::sqrt(first);  // amplitude of the angle, a sufficient first guess
  Eigen::Vector3d forces(size * kBuckling, kBuckling * kBuckling, -size * kBuckling);
  for (double at = first;; at = std::min(at + kStep, shortening)) {
    for (int iteration = 0;; ++iteration) {
      const Eigen::Vector3d off = missed(forces, 1 - at);
      if (off.norm() < 1e-10) break;
      if (iteration == 50) throw Error("no shape in balance", "pressedElastica", "press less");
      Eigen::Matrix3d slope;
      for (int c = 0; c < 3; ++c) {
        Eigen::Vector3d nudged = forces;
        nudged[c] += 1e-6;
        slope.col(c) = (missed(nudged, 1 - at) - off) / 1e-6;
      }
      const Eigen::Vector3d step = slope.fullPivLu().solve(off);
      forces -= step * std::min(1.0, 2 / step.norm());
    }
    if (at == shortening) break;
  }
  PressedElastica out{forces[1], forces[2], {}};
  for (int i = 0; i <= edges; ++i) {
    const State point = alongRod(forces, static_cast<double>(i) / edges);
    out.shape.emplace_back(static_cast<float>(point[2]), static_cast<float>(point[3]));
  }
  return out;
}

}  // namespace strandcast
