// The pace of several characters on one machine: who takes more than its share waits for those who do not.
#pragma once
#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>

namespace strandcast {

/// Whether the machine is too slow for its characters: it is where one that keeps its budget was late. One
/// that is late because its own frames take too long says nothing about the others, and does not count.
/// Thread-safe.
class StagePressure {
 public:
  using Clock = std::chrono::steady_clock;

  /// A character within its budget was late at `now`.
  void addLateFrame(Clock::time_point now);
  /// 1 for kHeld after a late frame, then less, 0 from kHeld + kFading on. A pace that returns at once would
  /// make the others late again each second.
  double at(Clock::time_point now) const;

  static constexpr Clock::duration kHeld = std::chrono::seconds(1), kFading = std::chrono::seconds(9);

 private:
  std::atomic<Clock::rep> last_late_{0};  ///< since the clock's epoch; 0 = never
};

/// The share of the machine that a character's frames may take, and its pace where they take more. Under
/// pressure its interval is longer by the factor cost / budget, so that it takes no more than its budget per
/// interval. Only the pace changes: steps and frames are the same. Not thread-safe.
class RateBudget {
 public:
  using Clock = StagePressure::Clock;

  /// `budget_ms`: ms of a frame, above 0. `rate`: frames per second. `pressure` must outlive this.
  RateBudget(double budget_ms, double rate, StagePressure& pressure)
      : budget_ms_(budget_ms), interval_ms_(1000 / rate), pressure_(pressure) {}

  /// A frame took `cost_ms` and was late or not. Returns the factor of the next intervals, at least 1. No
  /// interval gets longer than kLongestInterval, so that commands and statuses go on.
  double addFrame(double cost_ms, bool is_late, Clock::time_point now);
  double budget() const { return budget_ms_; }  ///< ms of a frame
  /// Mean of the last kFrames frames, ms; 0 before the first.
  double cost() const;

  static constexpr size_t kFrames = 60;
  static constexpr double kLongestInterval = 500;  ///< ms

 private:
  const double budget_ms_, interval_ms_;
  StagePressure& pressure_;
  std::array<double, kFrames> costs_{};  ///< ms, a ring
  size_t frames_ = 0;
};

}  // namespace strandcast
