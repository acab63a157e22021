#include "validation/beam_modes.h"

#include <cmath>
#include <numbers>

namespace strandcast {

double beamRoot(int n) {
  // cos(b) + 1 / cosh(b) changes its sign once within a quarter turn of (n - 1/2) pi.
  auto f = [](double b) { return std::cos(b) + 1 / std::cosh(b); };
  const double around = (n - 0.5) * std::numbers::pi;
  double low = around - 0.8, high = around + 0.8;
  const bool rises = f(high) > 0;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    ((f(middle) > 0) == rises ? high : low) = middle;
  }
  return low;
}

double beamShape(int n, double s) {
  const double b = beamRoot(n);
  const double ratio = (std::cosh(b) + std::cos(b)) / (std::sinh(b) + std::sin(b));
  return std::cosh(b * s) - std::cos(b * s) - ratio * (std::sinh(b * s) - std::sin(b * s));
}

}  // namespace strandcast
