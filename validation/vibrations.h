// Exact vibrations of beams, chains and pendulums, and the fit of a measured oscillation.
#pragma once
#include <cmath>
#include <span>

namespace strandcast {

/// The n-th root (1, 2, ...) of cos(b) cosh(b) = -1: a clamped beam of bending stiffness B, mass per length
/// mu and length L vibrates at b^2 sqrt(B / (mu L^4)) rad/s.
double beamRoot(int n);
/// Shape of mode n at arc length s in [0, 1] from the clamp (Euler-Bernoulli); 2 or -2 at the tip.
double beamShape(int n, double s);

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

/// Period of a point pendulum of the amplitude `angle` (rad, below pi), in units of that of small swings,
/// 2 pi sqrt(l / g): 1 / agm(1, cos(angle / 2)), Gauss's arithmetic-geometric mean.
double pendulumPeriod(double angle);

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
