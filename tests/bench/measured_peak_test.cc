// The peak that benchmarks hold the solver against, against the clock of the machine.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

#include "bench/measured_copy.h"
#include "bench/measured_run.h"
#include "bench/operation_count.h"
#include "simd/simd_kernels.h"

namespace strandcast {
namespace {

/// Cycles per second, by additions that wait for one another: one a cycle on every processor with vectors. In
/// this program's own time and in short pieces, since other programs run beside a test.
double cyclesPerSecond() {
  constexpr long kRounds = 2'000'000;
  double best = 0;
  for (int attempt = 0; attempt < 40; ++attempt) {
    uint64_t sum = 0, one = 1;
    asm volatile("" : "+r"(one));
    const double before = processorMs();
    for (long round = 0; round < kRounds; ++round) {
      // The compiler is not to know what comes out.
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

/// Bytes per second, read and written, of copies in the first cache, in this program's own time.
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

// Processors have two units for fused multiply-adds of their widest vectors, or one. What counts more has
// counted what the compiler left out; then no fraction of it means anything.
TEST(MeasuredPeak, IsWhatOneOrTwoUnitsCanDo) {
  const double per_cycle = 2.0 * simd::runnableTargets().front().kernel.lanes * cyclesPerSecond();
  EXPECT_LT(measuredPeakOfProcessor(), 2.2 * per_cycle);
  EXPECT_LT(measuredPeak(1), 2.2 * per_cycle);
  EXPECT_GT(measuredPeakOfProcessor(), 0.4 * per_cycle);
}

// A copy that the compiler left out, or one that stayed in a cache, would be faster. Others may be at memory
// too.
TEST(MeasuredCopy, IsWhatMemoryGivesAndNotACache) {
  const double in_cache = copiedInCache();
  EXPECT_LT(measuredCopy(1), 0.7 * in_cache);
  EXPECT_GT(measuredCopy(1), 0.002 * in_cache);
}

}  // namespace
}  // namespace strandcast
