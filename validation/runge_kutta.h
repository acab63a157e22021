#pragma once

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

}  // namespace strandcast
