// The peak that benchmarks hold the solver against, against the clock of the machine.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>

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

// Processors have two units for fused multiply-adds of their widest vectors, or one. What counts more has
// counted what the compiler left out; then no fraction of it means anything.
TEST(MeasuredPeak, IsWhatOneOrTwoUnitsCanDo) {
  const double per_cycle = 2.0 * simd::runnableTargets().front().kernel.lanes * cyclesPerSecond();
  EXPECT_LT(measuredPeakOfProcessor(), 2.2 * per_cycle);
  EXPECT_LT(measuredPeak(1), 2.2 * per_cycle);
  EXPECT_GT(measuredPeakOfProcessor(), 0.4 * per_cycle);
}

}  // namespace
}  // namespace strandcast
