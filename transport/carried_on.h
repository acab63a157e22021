#pragma once
#include <algorithm>

namespace strandcast {

/// How long the motion of what was lost is carried on; then it stands still.
inline constexpr double kLongestCarriedOn = 0.1;  // s

/// How much of its motion from the time `before` to the time `last` (s) is added to where a thing was last to
/// have where it probably is at `now`: 0 where that motion is too old to tell.
inline double carriedOn(double before, double last, double now) {
  const double between = last - before;
  const bool tells = between > 0 && between <= kLongestCarriedOn;
  return tells ? std::clamp(now - last, 0.0, kLongestCarriedOn) / between : 0.0;
}

}  // namespace strandcast
