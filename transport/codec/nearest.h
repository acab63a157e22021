#pragma once
#include <bit>
#include <cstdint>

namespace strandcast {

/// The nearest integer, ties to even, of |x| <= 2^22: the sum with 1.5 * 2^23 has no room for a fraction.
/// (lrintf is a call of the C library in every build that may set errno.)
inline int32_t nearest(float x) {
  constexpr float kShift = 12582912.0f;
  return std::bit_cast<int32_t>(x + kShift) - std::bit_cast<int32_t>(kShift);
}

}  // namespace strandcast
