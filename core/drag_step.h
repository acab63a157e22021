#pragma once
#include <cmath>

namespace strandcast {

/// Effect of air drag of `rate` (1/s) in a substep of `h` seconds, exact for forces that are constant in it
/// (exponential integrator; Hochbruck and Ostermann 2010; docs/solver.md (3)). The wind w and an acceleration
/// a change the velocity v to keep v + (1 - keep) w + a time2 / h. So terminal velocities, and wind that
/// balances weight and stiffness, are right in substeps of any length.
struct DragStep {
  DragStep(double rate, double h)
      : keep(std::exp(-rate * h)), time2(rate * h > 0 ? -std::expm1(-rate * h) * h / rate : h * h) {}
  double keep;   ///< exp(-rate h)
  double time2;  ///< s^2, h^2 without drag: displacement in the substep by an acceleration of 1 m/s^2
};

}  // namespace strandcast
