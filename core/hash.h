// Hashes of contents and of numbers.
#pragma once
#include <cstddef>
#include <cstdint>

namespace strandcast {

/// 64 bits over bytes, in the order they are added: FNV-1a (Fowler, Noll, Vo).
class ContentHash {
 public:
  void add(const void* data, size_t bytes) {
    const auto* p = static_cast<const unsigned char*>(data);
    for (size_t i = 0; i < bytes; ++i) value_ = (value_ ^ p[i]) * 1099511628211ull;
  }
  template <class T>
  void add(const T& value) {
    add(&value, sizeof(T));
  }
  uint64_t value() const { return value_; }

 private:
  uint64_t value_ = 14695981039346656037ull;
};

/// SplitMix64 (Steele, Lea, Flood 2014): hashes any number to well mixed bits. Applied to start, start +
/// kSplitMixStep, start + 2 kSplitMixStep and so on it is a random number generator.
constexpr uint64_t kSplitMixStep = 0x9e3779b97f4a7c15u;
constexpr uint64_t splitMix64(uint64_t x) {
  x += kSplitMixStep;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

}  // namespace strandcast
