#pragma once
#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace strandcast {

/// Numbers of 16 bits in Golomb-Rice codes (Rice, JPL 91-3): small ones take few bits, and `k` (0 to 16) says
/// what counts as small. A number is folded to z = 0, -1, 1, -2 ...; z >> k zeros, a one, and the k low bits
/// of z. Where that would be more than kMostZeros zeros, these, a one, and all 16 bits of z. Bits fill bytes
/// from the lowest up.
inline constexpr uint32_t kMostZeros = 20;

class RiceWriter {
 public:
  /// Appends to `bytes`; complete after finish().
  explicit RiceWriter(std::vector<uint8_t>& bytes) : bytes_(bytes) {}
  void put(uint16_t number, int k) {
    const uint32_t sign = number >> 15, z = ((uint32_t{number} << 1) ^ (0u - sign)) & 0xffffu;
    uint32_t zeros = z >> k, low = z & ((1u << k) - 1);
    if (zeros >= kMostZeros) zeros = kMostZeros, low = z, k = 16;
    window_ |= (uint64_t{1} << zeros | uint64_t{low} << (zeros + 1)) << filled_;
    filled_ += zeros + 1 + static_cast<uint32_t>(k);
    while (filled_ >= 8) {  // 37 bits and 7 that were left fit the window
      bytes_.push_back(static_cast<uint8_t>(window_));
      window_ >>= 8;
      filled_ -= 8;
    }
  }
  void finish() {
    if (filled_ > 0) bytes_.push_back(static_cast<uint8_t>(window_));
    window_ = filled_ = 0;
  }

 private:
  std::vector<uint8_t>& bytes_;
  uint64_t window_ = 0;
  uint32_t filled_ = 0;
};

class RiceReader {
 public:
  explicit RiceReader(std::span<const uint8_t> bytes) : bytes_(bytes) {}
  /// Anything where there is none; isSound() is false then.
  uint16_t get(int k) {
    fill();
    const auto zeros = static_cast<uint32_t>(std::countr_zero(window_));
    if (zeros > kMostZeros) {  // also past the end
      is_sound_ = false;
      return 0;
    }
    if (zeros == kMostZeros) k = 16;
    const auto low = static_cast<uint32_t>(window_ >> (zeros + 1)) & ((1u << k) - 1);
    const uint32_t z = zeros == kMostZeros ? low : (zeros << k) | low;
    window_ >>= zeros + 1 + static_cast<uint32_t>(k);
    used_ += zeros + 1 + static_cast<uint32_t>(k);
    is_sound_ &= z <= 0xffffu;
    return static_cast<uint16_t>(z >> 1 ^ (0u - (z & 1u)));
  }
  bool isSound() const { return is_sound_ && used_ <= 8 * bytes_.size(); }
  /// Nothing but the zeros that fill the last byte is left.
  bool isAtEnd() const { return isSound() && 8 * bytes_.size() - used_ < 8 && window_ == 0; }

 private:
  /// The next 56 bits or more, zeros past the end.
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

  std::span<const uint8_t> bytes_;
  uint64_t window_ = 0;
  size_t used_ = 0;  // bits
  bool is_sound_ = true;
};

}  // namespace strandcast
