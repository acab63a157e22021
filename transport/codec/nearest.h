#pragma once
#include <bit>
#include <cstdint>

namespace strandcast {

/// Nearest integer of x, ties to even; |x| <= 2^22. At 1.5 * 2^23 the spacing of floats is 1, so that the sum
/// rounds. (lrintf may set errno, and is therefore a library call in every build.)
inline int32_t nearest(float x) {
  constexpr float kShift = 12582912.0f;
  return std::bit_cast<int32_t>(x + kShift) - std::bit_cast<int32_t>(kShift);
}

}  // namespace strandcast
