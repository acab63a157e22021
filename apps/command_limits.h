#pragma once

namespace strandcast {

constexpr double kFarthestPlace = 1000;  ///< m, per axis, for positions in commands
constexpr double kRampSeconds = 0.2;     ///< default duration of a smooth motion by command
constexpr double kLongestWay = 3600;     ///< s, longest duration of a motion by command
constexpr size_t kMaxWindSources = 64;   ///< limit on the sources that commands may leave a daemon with

}  // namespace strandcast
