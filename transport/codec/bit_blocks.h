#pragma once
#include <cstddef>
#include <cstdint>

namespace strandcast {

/// Numbers of 16 bits, most of them small, with as many bits each as the largest of the eight beside it takes
/// (frame of reference: Zukowski et al., Super-Scalar RAM-CPU Cache Compression, ICDE 2006): many at once are
/// packed and unpacked in a few operations, by StrandCoder. docs/wire.md, "Blocks of bits".
inline constexpr size_t kBitBlock = 8;                  ///< numbers of one width
inline constexpr size_t kBitBlockPair = 2 * kBitBlock;  ///< behind one byte of widths
inline constexpr uint32_t kMostBlockWidth = 16;
/// What stands for kMostBlockWidth in a byte of two widths: 15 bits are written as 16.
inline constexpr uint32_t kWidestCode = 15;
inline constexpr size_t kMostPairBytes = 1 + 2 * kMostBlockWidth;

/// Room that so many numbers may take while they are packed.
inline constexpr size_t mostPackedBytes(size_t count) {
  return (count + kBitBlockPair - 1) / kBitBlockPair * kMostPairBytes + sizeof(uint64_t);
}

}  // namespace strandcast
