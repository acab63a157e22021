#pragma once
#include <span>
#include <utility>

namespace strandcast {

/// y = factor x^exponent, by least squares of log y against log x.
struct PowerLaw {
  double exponent = 0, factor = 0;
  double standard_error = 0;  ///< of the exponent; 0 with two points
};
/// Precondition: at least two points of different x, all coordinates above 0.
PowerLaw fitPowerLaw(std::span<const std::pair<double, double>> points);

}  // namespace strandcast
