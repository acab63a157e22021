#pragma once
#include <cstdint>

#include "core/hash.h"

namespace strandcast {

/// The random numbers of one sample of one pixel: a counter-based generator, so that they depend on these and
/// the seed alone, not on the order in which pixels are computed.
class SampleStream {
 public:
  SampleStream(uint64_t seed, uint64_t pixel, uint64_t sample)
      : state_(splitMix64(splitMix64(splitMix64(seed) ^ pixel) ^ (sample * kSplitMixStep + 1))) {}
  /// Uniform in [0, 1), 53 bits.
  double uniform() {
    const uint64_t bits = splitMix64(state_);
    state_ += kSplitMixStep;
    return static_cast<double>(bits >> 11) * 0x1p-53;
  }

 private:
  uint64_t state_;
};

}  // namespace strandcast
