#pragma once
#include <cmath>

namespace strandcast {

/// The tip's angle, above 0 and up to `wanted`, with which a rod that is followed from its tip has the angle
/// `wanted` at its clamp; clamp_angle(tip angle) grows with it. Bisection of its logarithm: the tip of a
/// heavy rod may be nearer to 0 than doubles are to 1.
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
