#include "bench/power_law.h"

#include <cmath>

namespace strandcast {

PowerLaw fitPowerLaw(std::span<const std::pair<double, double>> points) {
  const auto n = static_cast<double>(points.size());
  double mean_x = 0, mean_y = 0;
  for (const auto& [x, y] : points) {
    mean_x += std::log(x) / n;
    mean_y += std::log(y) / n;
  }
  double xx = 0, xy = 0, yy = 0;
  for (const auto& [x, y] : points) {
    const double dx = std::log(x) - mean_x, dy = std::log(y) - mean_y;
    xx += dx * dx;
    xy += dx * dy;
    yy += dy * dy;
  }
  PowerLaw law;
  law.exponent = xy / xx;
  law.factor = std::exp(mean_y - law.exponent * mean_x);
  if (points.size() > 2)
    law.standard_error = std::sqrt(std::max(0.0, yy - law.exponent * xy) / ((n - 2) * xx));
  return law;
}

}  // namespace strandcast
