#pragma once
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <chrono>

#include "collision/field_bake.h"

namespace strandcast {

/// Parallel loops that tell progress and stop between batches short enough for a person.
class BakeLoop {
 public:
  explicit BakeLoop(int threads) : arena_(threads > 0 ? threads : oneapi::tbb::task_arena::automatic) {}

  /// body(i) for i in [0, count), in any order. Progress goes from `from` to `to`.
  template <class Body>
  void run(size_t count, const BakeProgress& progress, const char* what, double from, double to, Body body) {
    size_t batch = 8;
    for (size_t begin = 0; begin < count;) {
      const double done = static_cast<double>(begin) / static_cast<double>(count);
      if (progress && !progress(what, from + done * (to - from))) throw BakeStopped();
      const auto start = Clock::now();
      const size_t end = begin + std::min(batch, count - begin);
      over(begin, end, body);
      begin = end;
      const double seconds = secondsSince(start);
      if (seconds < 0.05) batch *= 2;
      if (seconds > 0.2) batch = std::max<size_t>(batch / 2, 1);
    }
  }

  /// Seconds that all `count` would take, from a few of them spread evenly.
  template <class Body>
  double secondsFor(size_t count, const BakeProgress& progress, Body body) {
    constexpr size_t kBatch = 8, kMost = 128;
    constexpr double kEnough = 0.1;
    const size_t tries = std::min(count, kMost);
    const auto start = Clock::now();
    size_t done = 0;
    while (done < tries && secondsSince(start) < kEnough) {
      if (progress && !progress("estimating", 0)) throw BakeStopped();
      const size_t end = std::min(done + kBatch, tries);
      over(done, end, [&](size_t i) { body(i * count / tries); });
      done = end;
    }
    return done == 0 ? 0 : secondsSince(start) * static_cast<double>(count) / static_cast<double>(done);
  }

 private:
  using Clock = std::chrono::steady_clock;
  static double secondsSince(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
  }

  template <class Body>
  void over(size_t begin, size_t end, const Body& body) {
    arena_.execute([&] {
      oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<size_t>(begin, end), [&](const auto& range) {
        for (size_t i = range.begin(); i < range.end(); ++i) body(i);
      });
    });
  }

  oneapi::tbb::task_arena arena_;
};

}  // namespace strandcast
