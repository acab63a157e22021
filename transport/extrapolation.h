#pragma once
#include <algorithm>

namespace strandcast {

/// Longest time over which the motion of a lost object is extrapolated; then it stays at rest.
inline constexpr double kMaxExtrapolation = 0.1;  // s

/// Factor of the motion from time `before` to time `last` (s) that is added to the last position to estimate
/// the position at `now`. 0 where the motion spans more than kMaxExtrapolation.
inline double extrapolation(double before, double last, double now) {
  const double between = last - before;
  const bool tells = between > 0 && between <= kMaxExtrapolation;
  return tells ? std::clamp(now - last, 0.0, kMaxExtrapolation) / between : 0.0;
}

}  // namespace strandcast
