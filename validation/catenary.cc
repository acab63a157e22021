#include "validation/catenary.h"

#include <cmath>

namespace strandcast {

double catenarySag(double span) {
  // y = c cosh(x / c), with u = span / (2 c): length 1 = 2 c sinh(u), so sinh(u) / u = 1 / span, and the sag
  // is c (cosh(u) - 1) = tanh(u / 2) / 2.
  double low = 1e-9, high = 700;
  for (int i = 0; i < 80; ++i) {
    const double u = (low + high) / 2;
    (std::sinh(u) / u > 1 / span ? high : low) = u;
  }
  return std::tanh(low / 2) / 2;
}

}  // namespace strandcast
