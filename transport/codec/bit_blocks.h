#pragma once
#include <cstddef>
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

/// Packs 16-bit numbers in blocks of eight, each with as many bits per number as the largest of the block
/// needs (frame of reference: Zukowski et al., Super-Scalar RAM-CPU Cache Compression, ICDE 2006).
/// StrandCoder packs and unpacks whole blocks in a few operations. Format: docs/wire.md, "Blocks of bits".
inline constexpr size_t kBitBlock = 8;                  ///< numbers of one width
inline constexpr size_t kBitBlockPair = 2 * kBitBlock;  ///< numbers after one byte of widths
inline constexpr uint32_t kMaxBlockWidth = 16;
/// Code of kMaxBlockWidth in the byte of two widths: numbers of 15 bits are written with 16.
inline constexpr uint32_t kWidestCode = 15;
inline constexpr size_t kMaxPairBytes = 1 + 2 * kMaxBlockWidth;

/// Capacity that packing `count` numbers requires, bytes: the worst case, and one word for stores past the
/// end.
inline constexpr size_t maxPackedBytes(size_t count) {
  return (count + kBitBlockPair - 1) / kBitBlockPair * kMaxPairBytes + sizeof(uint64_t);
}

}  // namespace strandcast
