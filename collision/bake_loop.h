#pragma once
#include <oneapi/tbb/info.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <exception>
#include <future>
#include <system_error>
#include <vector>

#include "collision/body_distance.h"
#include "collision/field_bake.h"
#include "collision/mesh_query.h"
#include "core/distance_field.h"

namespace strandcast {

/// Parallel loops during which the calling thread reports progress and may be told to stop. Their threads
/// have the priority of the calling thread and end with the loop. oneTBB's workers would keep that priority
/// for all later work of the process.
class BakeLoop {
 public:
  /// `threads`: 0 = all of the machine.
  explicit BakeLoop(int threads)
      : threads_(static_cast<size_t>(threads > 0 ? threads : oneapi::tbb::info::default_concurrency())) {}

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
    constexpr size_t kBlocksPerThread = 32, kMaxBlock = 64;
    const size_t block = std::clamp<size_t>(count / (threads_ * kBlocksPerThread), 1, kMaxBlock);
    stopping_ = !keep_going(0);
    std::atomic<size_t> next{0}, done{0};
    const auto work = [&] {
      while (!stopping_) {
        const size_t first = next.fetch_add(block), last = std::min(first + block, count);
        if (first >= count) return;
        for (size_t i = first; i < last && !stopping_; ++i) {
          body(i);
          if (!stopping_) ++done;
        }
      }
    };
    std::exception_ptr failure;
    std::vector<std::future<void>> workers;
    try {
      while (workers.size() < std::min(threads_, count))
        workers.push_back(std::async(std::launch::async, work));
    } catch (const std::system_error&) {  // the system allows no more threads
      if (workers.empty()) throw;
    }
    for (std::future<void>& worker : workers) {
      while (worker.wait_for(std::chrono::milliseconds(20)) != std::future_status::ready)
        if (!keep_going(done)) stopping_ = true;
      try {
        worker.get();
      } catch (...) {
        stopping_ = true;
        if (!failure) failure = std::current_exception();
      }
    }
    if (failure) std::rethrow_exception(failure);
    return done;
  }

  const size_t threads_;
  std::atomic<bool> stopping_{false};
};

}  // namespace strandcast
