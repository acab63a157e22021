#pragma once
#include <cstdint>

namespace strandcast {

/// Maps signed numbers to unsigned ones of small magnitude: 0, -1, 1, -2 ... become 0, 1, 2, 3 ...
inline uint16_t zigzag(uint16_t number) { return static_cast<uint16_t>(number << 1 ^ -(number >> 15)); }
inline uint16_t unzigzag(uint16_t z) { return static_cast<uint16_t>(z >> 1 ^ -(z & 1)); }

/// Sign-extends the low `bits` bits; bits: 1 to 16.
inline uint16_t signExtended(uint16_t number, int bits) {
  const int spare = 16 - bits;
  return static_cast<uint16_t>(static_cast<int16_t>(number << spare) >> spare);
}

}  // namespace strandcast
