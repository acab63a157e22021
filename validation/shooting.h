#pragma once
#include <cmath>

namespace strandcast {

/// Finds the angle at the tip, in (0, wanted], for which integration from the tip gives the angle `wanted` at
/// the clamp. Precondition: clamp_angle(tip angle) increases. Bisects the logarithm: the tip angle of a heavy
/// rod may be smaller than the spacing of doubles at 1.
template <class ClampAngle>
double shootFromTip(double wanted, const ClampAngle& clamp_angle) {
  double low = std::log(1e-200), high = std::log(wanted);
  for (int i = 0; i < 80; ++i) {
    const double middle = (low + high) / 2;
    (clamp_angle(std::exp(middle)) > wanted ? high : low) = middle;
  }
  return std::exp(low);
}

}  // namespace strandcast
