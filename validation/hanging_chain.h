#pragma once

namespace strandcast {

/// The n-th root (1, 2, ...) of the Bessel function J0: a hanging chain of length L swings at
/// root / 2 x sqrt(g / L) rad/s (Daniel Bernoulli).
double chainRoot(int n);
/// Its shape at the place s in [0, 1] from the clamp: J0(root sqrt(1 - s)), 1 at the tip.
double chainShape(int n, double s);

}  // namespace strandcast
