#pragma once
#include <cstdint>

namespace strandcast {

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
