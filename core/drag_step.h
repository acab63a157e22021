#pragma once
#include <cmath>

namespace strandcast {

/// What air drag of `rate`, 1/s, makes of a substep of `h` seconds (s), exactly for forces that are constant
/// in it (exponential integrator; Hochbruck and Ostermann 2010): the wind w and an acceleration a leave a
/// velocity v at keep v + (1 - keep) w + a time2 / h. So what falls gets as fast as it should, and wind holds
/// hair against its weight and its stiffness, however long the substep.
struct DragStep {
  DragStep(double rate, double h)
      : keep(std::exp(-rate * h)), time2(rate * h > 0 ? -std::expm1(-rate * h) * h / rate : h * h) {}
  double keep;   ///< exp(-rate h)
  double time2;  ///< s^2, h^2 without drag: of an acceleration, how far it takes a vertex in the substep
};

}  // namespace strandcast
