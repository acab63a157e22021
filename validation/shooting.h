// Runge-Kutta steps and shooting, for the exact solutions.
#pragma once
#include <cmath>

namespace strandcast {

/// One classical Runge-Kutta step of length h of y' = slope(at, y); fourth order.
template <class State, class Slope>
State rungeKuttaStep(double at, const State& y, double h, const Slope& slope) {
  const State k1 = slope(at, y);
  const State k2 = slope(at + h / 2, State(y + h / 2 * k1));
  const State k3 = slope(at + h / 2, State(y + h / 2 * k2));
  const State k4 = slope(at + h, State(y + h * k3));
  return y + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
}

/// Finds the angle at the tip, in (0, wanted], for which integration from the tip gives the angle `wanted` at
/// the clamp. Precondition: clamp_angle(tip angle) increases. Bisects the logarithm: the tip angle of a heavy
/// rod may be smaller than the spacing of doubles at 1.
template <class ClampAngle>
double shootFromTip(double wanted, const ClampAngle& clamp_angle) {
  double low = std::log(1e-200), high = std::log(wanted);
  for (int i = 0; i < 80; ++i) {
    const double middle = (low + high) / 2;
    (clamp_angle(std::exp(middle)) > wanted ? high : low) = middle;
  }
  return std::exp(low);
}

}  // namespace strandcast
