#pragma once

namespace strandcast {

/// Smooth step from 0 to 1 over [0, 1] whose first two derivatives vanish at both ends; and its integral from
/// 0.
inline double ease(double u) { return u <= 0 ? 0 : u >= 1 ? 1 : u * u * u * (10 + u * (6 * u - 15)); }
inline double easeIntegral(double u) {
  return u <= 0 ? 0 : u >= 1 ? u - 0.5 : u * u * u * u * (2.5 + u * (u - 3));
}

constexpr double kStartSeconds = 0.5;  ///< s, time over which a motion starts from rest
constexpr double kLoopBlend = 0.25;    ///< s, time over which the end of a clip returns to its start

}  // namespace strandcast
