#pragma once
#include <span>

namespace strandcast {

/// A decaying swing about zero.
struct Oscillation {
  double angular_frequency = 0;  ///< rad/s, from the first to the last passage through zero
  double decrement = 0;          ///< natural logarithm of the ratio of amplitudes one cycle apart

  double dampingRatio() const;
  double energyLostPerCycle() const;  ///< part of it, 0 to 1
};

/// `samples` at equal intervals, s; at least three passages through zero, else all is not a number.
Oscillation oscillationOf(std::span<const double> samples, double interval);

}  // namespace strandcast
