#pragma once
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <optional>

namespace strandcast {

/// Due times of frames: one interval apart, or, where live sources want a frame at another time, up to 2 % of
/// the interval nearer to that. So a daemon keeps the pace of a sender's clock, and its steps their length.
class FramePacer {
 public:
  using Clock = std::chrono::steady_clock;

  /// `rate`: frames per second. The first frame is due at `start`.
  FramePacer(double rate, Clock::time_point start)
      : interval_(std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / rate))),
        due_(start) {}

  /// Due time of the next frame. `now`: the end of the present one. `wanted`: when the latest of the live
  /// sources' poses for the next frame will be here; none without live sources. A frame that is late is due
  /// at once, and those after it keep their intervals from there.
  Clock::time_point next(Clock::time_point now, std::optional<Clock::time_point> wanted = std::nullopt) {
    due_ += interval_ + std::chrono::duration_cast<Clock::duration>(interval_ * (slowdown_ - 1));
    if (wanted) due_ += std::clamp(*wanted - due_, -interval_ / 50, interval_ / 50);
    is_late_ = now > due_;
    if (is_late_) {
      ++late_frames_;
      due_ = now;
    }
    is_too_slow_ = (is_late_ || slowdown_ > 1) && wanted && due_ - *wanted > kFarthestBehind;
    return due_;
  }
  /// Multiplies the intervals from now on by `slowdown`, at least 1 (RateBudget).
  void setSlowdown(double slowdown) { slowdown_ = slowdown; }

  uint64_t lateFrames() const { return late_frames_; }
  /// Whether the frame that was asked for last is late.
  bool isLate() const { return is_late_; }
  /// Whether the frame is late or slowed down, and 0.25 s behind the time at which its poses are here: the
  /// machine does not keep the sender's pace, and poses must be skipped (PoseLock::release).
  bool isTooSlow() const { return is_too_slow_; }

 private:
  static constexpr Clock::duration kFarthestBehind = std::chrono::milliseconds(250);

  Clock::duration interval_;
  Clock::time_point due_;
  double slowdown_ = 1;
  uint64_t late_frames_ = 0;
  bool is_late_ = false, is_too_slow_ = false;
};

}  // namespace strandcast
