#include "validation/elastica.h"

#include <Eigen/Core>
#include <cmath>
#include <numbers>

#include "validation/runge_kutta.h"
#include "validation/shooting.h"

namespace strandcast {
namespace {

// psi = angle of the tangent from the vertical: psi'' = (gamma u + alpha) sin psi over the distance u from
// the tip. Measured from the vertical, the tip of a heavy rod keeps its digits however close to hanging it
// is.
using State = Eigen::Vector4d;  // psi, psi', drop, reach

State atClamp(double gamma, double alpha, double tip_angle) {
  constexpr int kSteps = 2000;
  State y(tip_angle, 0, 0, 0);
  for (int i = 0; i < kSteps; ++i)
    y = rungeKuttaStep(static_cast<double>(i) / kSteps, y, 1.0 / kSteps, [&](double u, const State& at) {
      return State(at[1], (gamma * u + alpha) * std::sin(at[0]), std::cos(at[0]), std::sin(at[0]));
    });
  return y;
}

}  // namespace

ElasticaTip restingElastica(double gamma, double alpha) {
  constexpr double kHorizontal = std::numbers::pi / 2;
  const double tip_angle =
      shootFromTip(kHorizontal, [&](double angle) { return atClamp(gamma, alpha, angle)[0]; });
  const State clamp = atClamp(gamma, alpha, tip_angle);
  return {clamp[2], clamp[3]};
}

}  // namespace strandcast
