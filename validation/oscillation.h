#pragma once
#include <span>

namespace strandcast {

/// A damped oscillation about zero.
struct Oscillation {
  double angular_frequency = 0;  ///< rad/s, from the first to the last zero crossing
  double decrement = 0;          ///< logarithmic decrement: ln of the ratio of successive amplitudes

  double dampingRatio() const;
  double energyLostPerCycle() const;  ///< fraction, 0 to 1
};

/// Fits `samples` at equal intervals (s). All results are NaN with fewer than three zero crossings.
Oscillation oscillationOf(std::span<const double> samples, double interval);

}  // namespace strandcast
