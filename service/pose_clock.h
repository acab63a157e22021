// The clocks of a live source of poses: PoseClock relates the sender's clock to wall time, PoseLock relates
// it to simulation time. Neither knows poses. All times are ns, 0 to 2^62. The sender's clock may have any
// origin; arrivals are of the steady clock, and simulation time is that of the end of a step.
#pragma once
#include <array>
#include <cstdint>
#include <limits>

namespace strandcast {

inline constexpr int64_t kNsPerSecond = 1'000'000'000, kNsPerMillisecond = 1'000'000;

/// When a sender's samples arrive. The offset is the least difference of arrival and sender's time within the
/// last ten seconds, as in the clock filter of NTP (RFC 5905, section 10). It follows a drift of 200 ppm
/// within 2 ms. The least one-way delay is part of it and cannot be told apart.
class PoseClock {
 public:
  /// Counts a sample that arrives for the first time. One that a later message repeats counts, too, so that
  /// the lateness includes the repair of losses. One that PoseLock leaves out does not. Arrivals do not
  /// decrease.
  void arrive(int64_t sender_ns, int64_t arrival_ns);
  /// Forgets all arrivals: the sender's clock was set.
  void restart() { *this = {}; }

  /// Steady time less sender's time of the fastest arrivals. Constant in silence; 0 before the first arrival.
  int64_t offset() const { return offset_; }
  /// The longest that a sample of the last ten seconds came after the fastest ones.
  int64_t lateness() const { return lateness_; }
  /// Steady time at which a sample has arrived, and those of the next `wait_ns`, with a reserve of 1 ms. At
  /// most `longest_ns` after the fastest arrival.
  int64_t wallOf(int64_t sender_ns, int64_t wait_ns, int64_t longest_ns) const;

 private:
  /// Arrivals of one second of the steady clock.
  struct Second {
    int64_t second = std::numeric_limits<int64_t>::min();  ///< the least: none
    int64_t least = 0;                                     ///< difference of arrival and sender's time
    int64_t lateness = 0;                                  ///< greatest excess over the offset of its time
  };
  std::array<Second, 10> seconds_;
  int64_t offset_ = 0, lateness_ = 0;
};

/// The sender's time that a step takes: the end of the step less a delay. The delay is set when the source is
/// locked. Afterwards it follows only the phase of the samples, so that each sample falls on a step. A lock
/// follows an arrival, never silence, and two are at least half a second apart.
class PoseLock {
 public:
  /// Notes a message whose newest sample is of `sender_ns`, before the step that ends at `step_end_ns`.
  /// `is_new_epoch`: the sender says that its motion jumps or its clock was set. False where the sample
  /// belongs to another timeline: it is far (0.5 s) from the step's time, and as far from the time that the
  /// sender's clock has shown at such an arrival. Such samples are left out until the next lock. One that is
  /// far from the step's time alone is taken: the daemon was paused, or is too slow.
  bool arrive(int64_t sender_ns, bool is_new_epoch, int64_t arrival_ns, int64_t step_end_ns);
  /// Sets the delay so that the step takes the newest sample, where a lock is due: after the first message,
  /// after 8 far ones in succession or a far one of a new epoch, and after release(). True where it did. Call
  /// once per step, after its messages.
  /// `hold_ns`: by how much the step takes an earlier time than that of the newest sample, 0 or more.
  bool lockIfDue(int64_t step_end_ns, int64_t hold_ns = 0);
  /// Whether the last lock began another timeline: it was the first, or the sender's clock was set. Earlier
  /// samples then have no place among the later ones, nor has their clock.
  bool beganTimeline() const { return began_timeline_; }
  /// Holds the newest sample back after a lock that could not know by how much. Nothing happens before it.
  void holdBack(int64_t step_end_ns, int64_t hold_ns) {
    if (is_locked_) delay_ = step_end_ns - newest_ + hold_ns;
  }
  /// The next arrival locks: the daemon was paused, or is too slow for the sender. Until then the delay
  /// stays.
  void release() { is_due_ = true; }

  /// Takes the delay of another daemon that is locked to the same source. Nothing happens before the first
  /// lock.
  void adopt(int64_t delay_ns) {
    if (is_locked_) delay_ = delay_ns;
  }

  bool isLocked() const { return is_locked_; }
  int64_t delay() const { return delay_; }
  uint32_t locks() const { return locks_; }  ///< since the start
  int64_t timeOf(int64_t step_end_ns) const { return step_end_ns - delay_; }
  /// Moves the times of steps towards a sample: it is `error_ns` before the step that took it. At most 0.5 %
  /// of a step.
  void followPhase(int64_t error_ns, int64_t step_ns);
  /// The same at once, unless it is more than half a step: for the first step after a rest.
  void takePhase(int64_t error_ns, int64_t step_ns);

 private:
  bool is_locked_ = false, is_due_ = true;
  bool has_arrival_ = false;  ///< since the last step
  bool is_foreign_ = false;   ///< the last message belongs to another timeline
  bool began_timeline_ = false;
  int64_t offset_ = 0;  ///< arrival less sender's time, of the last message of this timeline
  uint32_t locks_ = 0;
  int far_ = 0;                                       ///< far messages in succession
  int64_t newest_ = 0, arrival_ = 0, locked_at_ = 0;  ///< sender's time and arrival of the last message
  int64_t delay_ = 0;
};

}  // namespace strandcast
