#pragma once
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <future>
#include <vector>

#include "collision/body_distance.h"
#include "collision/field_bake.h"
#include "collision/mesh_query.h"
#include "core/distance_field.h"

namespace strandcast {

/// Parallel loops during which the calling thread reports progress and may be told to stop.
class BakeLoop {
 public:
  explicit BakeLoop(int threads) : arena_(threads > 0 ? threads : oneapi::tbb::task_arena::automatic) {}

  /// True once the loop is to stop. Long bodies should poll it and return at once; their results are then
  /// discarded.
  const std::atomic<bool>& stopping() const { return stopping_; }

  /// Runs body(i) for i in [0, count), in any order. Progress goes from `from` to `to`. Throws BakeStopped.
  template <class Body>
  void run(size_t count, const BakeProgress& progress, const char* what, double from, double to, Body body) {
    bool stopped = false;
    over(count, body, [&](size_t done) {
      const double part = count > 0 ? static_cast<double>(done) / static_cast<double>(count) : 1;
      stopped = stopped || (progress && !progress(what, from + part * (to - from)));
      return !stopped;
    });
    if (stopped) throw BakeStopped();
  }

  /// Estimates the seconds that all `count` bodies take, from those that finish within a quarter of a second.
  /// If none finishes, the elapsed time is the time of one body. Throws BakeStopped.
  template <class Body>
  double secondsFor(size_t count, const BakeProgress& progress, Body body) {
    constexpr size_t kMax = 128, kStride = 53;  // a stride that spreads the sample over all indices
    constexpr double kLongest = 0.25;
    const size_t tries = std::min(count, kMax);
    const auto start = Clock::now();
    bool stopped = false;
    const size_t done = over(
        tries, [&](size_t i) { body(i * kStride % tries * count / tries); },
        [&](size_t) {
          stopped = stopped || (progress && !progress("estimating", 0));
          return !stopped && std::chrono::duration<double>(Clock::now() - start).count() < kLongest;
        });
    if (stopped) throw BakeStopped();
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    return seconds * static_cast<double>(count) / static_cast<double>(std::max<size_t>(done, 1));
  }

 private:
  using Clock = std::chrono::steady_clock;

  /// Calls keep_going(number of bodies done) every 20 ms until all are done or it returns false. Returns the
  /// number done.
  template <class Body, class Continue>
  size_t over(size_t count, const Body& body, Continue keep_going) {
    stopping_ = !keep_going(0);
    std::atomic<size_t> done{0};
    std::future<void> work = std::async(std::launch::async, [&] {
      arena_.execute([&] {
        oneapi::tbb::parallel_for(size_t{0}, count, [&](size_t i) {
          if (stopping_) return;
          body(i);
          if (!stopping_) ++done;
        });
      });
    });
    while (work.wait_for(std::chrono::milliseconds(20)) != std::future_status::ready)
      if (!keep_going(done)) stopping_ = true;
    work.get();
    return done;
  }

  oneapi::tbb::task_arena arena_;
  std::atomic<bool> stopping_{false};
};

}  // namespace strandcast
