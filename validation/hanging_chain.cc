#include "validation/hanging_chain.h"

#include <cmath>
#include <numbers>

namespace strandcast {

double chainRoot(int n) {
  double x = (n - 0.25) * std::numbers::pi;  // McMahon's first term; Newton's method does the rest
  for (int i = 0; i < 20; ++i) x += std::cyl_bessel_j(0, x) / std::cyl_bessel_j(1, x);
  return x;
}

double chainShape(int n, double s) {
  return std::cyl_bessel_j(0, chainRoot(n) * std::sqrt(std::fmax(0.0, 1 - s)));
}

}  // namespace strandcast
