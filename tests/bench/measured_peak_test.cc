// The peak that benchmarks compare the solver with, against the clock rate of the machine.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

#include "bench/bench_simulation.h"
#include "bench/machine.h"
#include "simd/simd_kernels.h"

namespace strandcast {
namespace {

/// Clock rate, Hz, by dependent additions: one per cycle on every CPU with vector units. In processor time
/// and in short pieces, because other programs run beside the test.
double cyclesPerSecond() {
  constexpr long kRounds = 2'000'000;
  double best = 0;
  for (int attempt = 0; attempt < 40; ++attempt) {
    uint64_t sum = 0, one = 1;
    asm volatile("" : "+r"(one));
    const double before = processorMs();
    for (long round = 0; round < kRounds; ++round) {
      // Prevents the compiler from evaluating the sum.
#define ADDITION \
  sum += one;    \
  asm volatile("" : "+r"(sum))
      ADDITION;
      ADDITION;
      ADDITION;
      ADDITION;
      ADDITION;
      ADDITION;
      ADDITION;
      ADDITION;
#undef ADDITION
    }
    best = std::max(best, 8.0 * kRounds / (1e-3 * (processorMs() - before)));
  }
  return best;
}

/// Bytes per second, read and written, of copies within the L1 cache, in processor time.
double copiedInCache() {
  constexpr int kRounds = 20'000;
  std::array<char, 8192> from{}, to{};
  double best = 0;
  for (int attempt = 0; attempt < 20; ++attempt) {
    const double before = processorMs();
    for (int round = 0; round < kRounds; ++round) {
      std::memcpy(to.data(), from.data(), from.size());
      asm volatile("" : : "r"(to.data()) : "memory");
    }
    best =
        std::max(best, 2.0 * kRounds * static_cast<double>(from.size()) / (1e-3 * (processorMs() - before)));
  }
  return best;
}

// CPUs have one or two units for fused multiply-adds of their widest vectors. A higher rate means that the
// compiler removed operations, so fractions of the peak would be meaningless.
TEST(MeasuredPeak, IsWhatOneOrTwoUnitsCanDo) {
  const double per_cycle = 2.0 * simd::runnableTargets().front().kernel.lanes * cyclesPerSecond();
  EXPECT_LT(measuredPeakOfProcessor(), 2.2 * per_cycle);
  EXPECT_LT(measuredPeak(1), 2.2 * per_cycle);
  EXPECT_GT(measuredPeakOfProcessor(), 0.4 * per_cycle);
}

// A copy that the compiler removed, or one within a cache, would be faster. Other programs may use the memory
// meanwhile.
TEST(MeasuredCopy, IsWhatMemoryGivesAndNotACache) {
  const double in_cache = copiedInCache();
  EXPECT_LT(measuredCopy(1), 0.7 * in_cache);
  EXPECT_GT(measuredCopy(1), 0.002 * in_cache);
}

}  // namespace
}  // namespace strandcast
