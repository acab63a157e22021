#include "validation/pendulum.h"

#include <cmath>

namespace strandcast {

double pendulumPeriod(double angle) {
  double a = 1, g = std::cos(angle / 2);
  for (int i = 0; i < 8; ++i) {
    const double mean = (a + g) / 2;
    g = std::sqrt(a * g);
    a = mean;
  }
  return 1 / a;
}

}  // namespace strandcast
