#pragma once
#include <cmath>

namespace strandcast {

/// The n-th root (1, 2, ...) of the Bessel function J0: a hanging chain of length L swings at
/// root / 2 x sqrt(g / L) rad/s (Daniel Bernoulli).
double chainRoot(int n);
/// Shape of mode n at arc length s in [0, 1] from the clamp: J0(root sqrt(1 - s)); 1 at the tip.
double chainShape(int n, double s);

/// A hanging chain whose mass per length changes linearly to `tip` (above 0) times that at the clamp. Mode n
/// (1, 2,
/// ...) swings at frequency() x sqrt(g / L) rad/s. Solved by shooting from the tip. In the limit `tip` = 0
/// the frequency is half a root of the Bessel function J1 times sqrt(1/2).
class UnevenChain {
 public:
  UnevenChain(int n, double tip);
  double frequency() const { return std::sqrt(square_); }
  /// Shape at arc length s in [0, 1] from the clamp; 1 at the tip.
  double shape(double s) const;

 private:
  double tip_, square_;
};

}  // namespace strandcast
