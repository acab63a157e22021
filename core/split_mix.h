#pragma once
#include <cstdint>

namespace strandcast {

/// SplitMix64 (Steele, Lea, Flood 2014): well mixed bits of any number. Of 0, kSplitMixStep, 2 kSplitMixStep
/// and so on, from any start, it is a stream of random ones.
constexpr uint64_t kSplitMixStep = 0x9e3779b97f4a7c15u;
constexpr uint64_t splitMix64(uint64_t x) {
  x += kSplitMixStep;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

}  // namespace strandcast
