#include "validation/elastica.h"

#include <Eigen/Core>
#include <cmath>
#include <numbers>

#include "validation/runge_kutta.h"
#include "validation/shooting.h"

namespace strandcast {
namespace {

// psi: angle of the tangent from the vertical. Over the distance u from the tip psi' = m / b, m' = (force +
// alpha) sin psi, with moment m, stiffness b and force = weight beyond u, relative to their values at the
// clamp. Measured from the vertical, the tip angle of a heavy rod keeps its relative precision near 0.
using State = Eigen::Vector4d;  // psi, m, drop, reach

State atClamp(double gamma, double alpha, const ElasticaStep& step, double tip_angle) {
  State y(tip_angle, 0, 0, 0);
  const double outer = 1 - step.place;
  // force(u): weight beyond; u is counted from `from`
  auto follow = [&](double from, double to, double stiffness, auto force) {
    const int steps = static_cast<int>(std::ceil(2000 * (to - from)));
    const double h = (to - from) / steps;
    for (int i = 0; i < steps; ++i)
      y = rungeKuttaStep(i * h, y, h, [&](double u, const State& at) {
        return State(at[1] / stiffness, (gamma * force(u) + alpha) * std::sin(at[0]), std::cos(at[0]),
                     std::sin(at[0]));
      });
  };
  const double at_tip = step.weight + step.weight_growth;
  auto beyond = [&](double u) { return u * (at_tip - step.weight_growth * u / (2 * outer)); };
  follow(0, outer, step.stiffness, beyond);
  const double outer_weight = outer > 0 ? beyond(outer) : 0;
  follow(outer, 1, 1, [&](double u) { return outer_weight + u; });
  return y;
}

}  // namespace

ElasticaTip restingElastica(double gamma, double alpha, const ElasticaStep& step) {
  constexpr double kHorizontal = std::numbers::pi / 2;
  const double tip_angle =
      shootFromTip(kHorizontal, [&](double angle) { return atClamp(gamma, alpha, step, angle)[0]; });
  const State clamp = atClamp(gamma, alpha, step, tip_angle);
  return {clamp[2], clamp[3]};
}

}  // namespace strandcast
