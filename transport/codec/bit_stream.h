#pragma once
#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace strandcast {

/// Numbers of 16 bits in Golomb-Rice codes (Rice, JPL 91-3): small ones take few bits, and `k` (0 to 16) says
/// what counts as small. A number is folded to z = 0, -1, 1, -2 ...; z >> k zeros, a one, and the k low bits
/// of z. Where that would be more than kMostZeros zeros, these, a one, and all 16 bits of z. Bits fill bytes
/// from the lowest up.
inline constexpr uint32_t kMostZeros = 20;
inline constexpr size_t kMostRiceBits = kMostZeros + 1 + 16;

inline uint32_t riceFolded(uint16_t number) {
  return ((uint32_t{number} << 1) ^ (0u - (uint32_t{number} >> 15))) & 0xffffu;
}
inline uint16_t riceUnfolded(uint32_t z) { return static_cast<uint16_t>(z >> 1 ^ (0u - (z & 1u))); }
/// |number|, of the folded one.
inline uint32_t riceSize(uint32_t z) { return (z + 1) >> 1; }

class RiceWriter {
 public:
  /// `to` has room for kMostRiceBits per number and 8 bytes beyond.
  explicit RiceWriter(uint8_t* to) : to_(to) {}
  void put(uint32_t z, int k) {
    uint32_t zeros = z >> k, low = z & ((1u << k) - 1);
    if (zeros >= kMostZeros) zeros = kMostZeros, low = z, k = 16;
    append((uint64_t{low} << 1 | 1) << zeros, zeros + 1 + static_cast<uint32_t>(k));
  }
  /// Both at once where that is quicker.
  void put(uint32_t a, uint32_t b, int k) {
    const uint32_t mask = (1u << k) - 1, zeros_a = a >> k, zeros_b = b >> k;
    const uint32_t bits_a = zeros_a + 1 + static_cast<uint32_t>(k);
    const uint32_t bits = bits_a + zeros_b + 1 + static_cast<uint32_t>(k);
    if (std::max(zeros_a, zeros_b) < kMostZeros && bits <= kRoom) {
      append((uint64_t{a & mask} << 1 | 1) << zeros_a | (uint64_t{b & mask} << 1 | 1) << zeros_b << bits_a,
             bits);
    } else {
      put(a, k);
      put(b, k);
    }
  }
  /// Where the bytes end.
  const uint8_t* finish() {
    if (filled_ > 0) ++to_;  // append() has written it
    filled_ = 0;
    window_ = 0;
    return to_;
  }

 private:
  static constexpr uint32_t kRoom = 56;  // bits beside the 7 that may be left
  void append(uint64_t code, uint32_t bits) {
    window_ |= code << filled_;
    filled_ += bits;
    std::memcpy(to_, &window_, sizeof window_);
    const uint32_t whole = filled_ / 8;
    to_ += whole;
    window_ >>= 8 * whole;  // 7 bytes at most
    filled_ %= 8;
  }

  uint8_t* to_;
  uint64_t window_ = 0;
  uint32_t filled_ = 0;
};

class RiceReader {
 public:
  explicit RiceReader(std::span<const uint8_t> bytes) : bytes_(bytes) {}
  /// Folded. Anything where there is none; isSound() is false then.
  uint32_t get(int k) {
    fill();
    const auto zeros = static_cast<uint32_t>(std::countr_zero(window_));
    if (zeros > kMostZeros) {  // also past the end
      is_sound_ = false;
      return 0;
    }
    if (zeros == kMostZeros) k = 16;
    const auto low = static_cast<uint32_t>(window_ >> (zeros + 1)) & ((1u << k) - 1);
    const uint32_t z = zeros == kMostZeros ? low : (zeros << k) | low;
    take(zeros + 1 + static_cast<uint32_t>(k));
    is_sound_ &= z <= 0xffffu;
    return z & 0xffffu;
  }
  /// The next two.
  void get(int k, uint32_t& a, uint32_t& b) {
    fill();
    const auto zeros_a = static_cast<uint32_t>(std::countr_zero(window_));
    if (zeros_a < kMostZeros) {
      const uint64_t behind_a = window_ >> (zeros_a + 1), at_b = behind_a >> k;
      const auto zeros_b = static_cast<uint32_t>(std::countr_zero(at_b));
      const uint32_t bits = zeros_a + zeros_b + 2 + 2 * static_cast<uint32_t>(k);
      if (zeros_b < kMostZeros && bits <= kSeen) {
        const uint32_t mask = (1u << k) - 1;
        a = zeros_a << k | (static_cast<uint32_t>(behind_a) & mask);
        b = zeros_b << k | (static_cast<uint32_t>(at_b >> (zeros_b + 1)) & mask);
        take(bits);
        is_sound_ &= (a | b) <= 0xffffu;
        a &= 0xffffu;
        b &= 0xffffu;
        return;
      }
    }
    a = get(k);
    b = get(k);
  }
  bool isSound() const { return is_sound_ && used_ <= 8 * bytes_.size(); }
  /// Nothing but the zeros that fill the last byte is left.
  bool isAtEnd() {
    if (!isSound() || 8 * bytes_.size() - used_ >= 8) return false;
    fill();
    return window_ == 0;
  }

 private:
  static constexpr uint32_t kSeen = 57;  // bits that fill() makes sure of
  /// The next kSeen bits or more, zeros past the end.
  void fill() {
    const size_t place = used_ / 8;
    if (place + sizeof window_ <= bytes_.size()) {
      std::memcpy(&window_, bytes_.data() + place, sizeof window_);
    } else {
      window_ = 0;
      for (size_t i = place; i < bytes_.size(); ++i) window_ |= uint64_t{bytes_[i]} << (8 * (i - place));
    }
    window_ >>= used_ % 8;
  }
  void take(uint32_t bits) { used_ += bits; }

  std::span<const uint8_t> bytes_;
  uint64_t window_ = 0;
  size_t used_ = 0;  // bits
  bool is_sound_ = true;
};

}  // namespace strandcast
