#pragma once
#include <cmath>

namespace strandcast {

/// The n-th root (1, 2, ...) of the Bessel function J0: a hanging chain of length L swings at
/// root / 2 x sqrt(g / L) rad/s (Daniel Bernoulli).
double chainRoot(int n);
/// Its shape at the place s in [0, 1] from the clamp: J0(root sqrt(1 - s)), 1 at the tip.
double chainShape(int n, double s);

/// A hanging chain whose mass per length goes evenly from that at its clamp to `tip` (more than 0) times it:
/// its n-th mode (1, 2, ...) swings at frequency x sqrt(g / L) rad/s. Found by shooting from the tip. Where
/// `tip` is 0 it would be half a root of the Bessel function J1 times sqrt(1/2).
class UnevenChain {
 public:
  UnevenChain(int n, double tip);
  double frequency() const { return std::sqrt(square_); }
  /// At the place s in [0, 1] from the clamp, 1 at the tip.
  double shape(double s) const;

 private:
  double tip_, square_;
};

}  // namespace strandcast
