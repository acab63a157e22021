#pragma once

namespace strandcast {

/// The n-th root (1, 2, ...) of cos(b) cosh(b) = -1: a clamped beam of bending stiffness B, mass per length
/// mu and length L vibrates at b^2 sqrt(B / (mu L^4)) rad/s.
double beamRoot(int n);
/// Shape of mode n at arc length s in [0, 1] from the clamp (Euler-Bernoulli); 2 or -2 at the tip.
double beamShape(int n, double s);

}  // namespace strandcast
