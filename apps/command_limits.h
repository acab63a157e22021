#pragma once

namespace strandcast {

constexpr double kFarthestPlace = 1000;  ///< m, on each axis, of what a command places
constexpr double kRampSeconds = 0.2;  ///< in which a command's way is gone, smoothly, where it does not say
constexpr double kLongestWay = 3600;  ///< s, that a command may give it
constexpr size_t kMostWindSources = 64;  ///< that commands leave a daemon with

}  // namespace strandcast
