#include "validation/wind_elastica.h"

#include <Eigen/Core>
#include <cmath>
#include <numbers>

#include "validation/runge_kutta.h"
#include "validation/shooting.h"

namespace strandcast {
namespace {

constexpr double kAcross = std::numbers::pi / 2;

// psi: angle of the tangent (sin psi, cos psi) from the wind. Over the distance from the tip psi'' = t_x N_y
// - t_y N_x; the force N of the part beyond grows by the drag.
using State = Eigen::Matrix<double, 6, 1>;  // psi, psi', N across and downwind, position across and downwind

// State at the clamp, or where the strand turns against the wind before the clamp.
State atClamp(double load, double ratio, double tip_angle) {
  constexpr int kSteps = 2000;
  State y = State::Zero();
  y[0] = tip_angle;
  for (int i = 0; i < kSteps && y[0] <= kAcross; ++i)
    y = rungeKuttaStep(static_cast<double>(i) / kSteps, y, 1.0 / kSteps, [&](double, const State& at) {
      const double s = std::sin(at[0]), c = std::cos(at[0]);
      State slope;
      slope << at[1], s * at[3] - c * at[2], -load * (1 - ratio) * s * c, load * (s * s + ratio * c * c), s,
          c;
      return slope;
    });
  return y;
}

}  // namespace

WindElasticaTip windElastica(double load, double along_over_across) {
  const double tip_angle =
      shootFromTip(kAcross, [&](double angle) { return atClamp(load, along_over_across, angle)[0]; });
  const State clamp = atClamp(load, along_over_across, tip_angle);
  return {clamp[5], clamp[4]};
}

}  // namespace strandcast
