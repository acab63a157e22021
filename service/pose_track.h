#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "core/geometry.h"

namespace strandcast {

/// A moment of a live source's motion. Every pose is a motion from rest: x_world = rotation * x_rest +
/// position.
struct PoseSample {
  uint32_t number = 0;         ///< counts samples, wraps
  uint32_t epoch = 0;          ///< counts jumps of the motion, wraps
  int64_t time_ns = 0;         ///< sender's clock, 0 to 2^62
  std::vector<Pose> poses;     ///< m and unit quaternions, finite, one per slot
  std::vector<Vec3> scales;    ///< one per slot, or none
  std::vector<float> weights;  ///< of morph targets
};

/// What a step's poses are made of.
enum class PoseState {
  kNone,           ///< no sample has come
  kLive,           ///< a sample, or samples on both sides
  kExtrapolating,  ///< the last samples, which are less old than is extrapolated
  kResting,        ///< the last samples; they stay where extrapolation ended
  kRejoining       ///< live, with a decreasing difference to what was shown without samples
};

/// The samples of one source in order of time, and the poses that steps take of them. Poses are a function of
/// samples and of the steps' times. Arrival times count only where a sample comes after its step.
///
/// - A sample within 1 % of a step of the step's time is taken bit for bit.
/// - Between samples at most 250 ms apart a cubic Hermite spline interpolates. Its tangents use no later
///   sample than the second one, so that a step waits for one period only: backward differences of third
///   order, error 0.024 h^4 x'''' at equal spacing h.
/// - After the last sample the motion decelerates evenly and rests after `extrapolate` seconds, half as far
///   as at its speed.
/// - When samples come back, the difference to what was shown vanishes along a cubic smoothstep.
/// - Where the motion jumps (epoch, speed, or a difference too large to vanish), the step is a cut.
///
/// A slot's place is that of its pivot. So a head that turns about its neck, far from the world's origin,
/// still does so between samples. Memory is bounded and allocated by the constructor alone.
class PoseTrack {
 public:
  /// What samples contain.
  struct Slots {
    std::vector<Vec3> pivots;  ///< m, per slot: the point at rest about which it usually turns
    bool has_scales = false;
    size_t weights = 0;
    /// The slot that carries the hair, whose jumps are cuts; none: any slot's.
    std::optional<size_t> carrier;
  };
  /// `extrapolate`: s, 0 to 1.
  explicit PoseTrack(Slots slots, double extrapolate = 0.1);

  enum class Arrival {
    kNew,
    kRepeated,  ///< already here
    kLate       ///< came after its step. Used only where that step and those since had no newer sample
  };
  /// Takes a sample, whose sizes are those of the slots. At most 512 samples are kept, which is 0.25 s of
  /// waiting and as much of the past at 1 kHz.
  Arrival add(const PoseSample& sample);
  /// Forgets all samples, but not what was shown: the sender's clock was set (PoseLock::beganTimeline).
  void forget() {
    size_ = 0;
    base_time_ = reach_ = kNever;
    is_held_ = true;
  }

  /// What a step takes.
  struct Step {
    PoseState state = PoseState::kNone;
    bool is_exact = false;  ///< a sample falls on the step; a live step shows its bits
    bool is_cut = false;    ///< the motion jumps here: nothing moves from the poses before to these
    PoseSample shown;       ///< number, epoch and time of the newest sample that the step has reached
  };
  /// Takes the poses at `time_ns`, sender's clock, at the end of a step of `step_ns`. The steps' times may
  /// jump, by more than the phase of samples that PoseLock follows; the poses then rejoin. Valid until the
  /// next call.
  const Step& advance(int64_t time_ns, int64_t step_ns);

  static constexpr int64_t kLongestInterval = 250'000'000;  ///< ns, between samples that are interpolated

  /// Time of the sample nearest to a time.
  std::optional<int64_t> nearest(int64_t time_ns) const;

 private:
  static constexpr size_t kCapacity = 512, kTangentSamples = 4;
  static constexpr int64_t kNever = std::numeric_limits<int64_t>::min();

  /// A weighted sum of differences to the base sample.
  struct Blend {
    struct Term {
      size_t sample;
      double weight;
    };
    std::array<Term, 2 * kTangentSamples + 2> terms;
    size_t count = 0;
    void add(size_t sample, double weight) { terms[count++] = {sample, weight}; }
  };
  /// How the poses at a time were found.
  struct Reading {
    size_t base;                             ///< the newest sample up to the time
    bool is_exact = false, is_held = false;  ///< held: extrapolated or at rest
  };
  /// What is added to the samples' motion while it rejoins, per slot at its pivot.
  struct Offset {
    Eigen::Vector3d move, turn;  ///< m; rotation vector, rad, world axes
  };

  PoseSample& sample(size_t i) { return ring_[(begin_ + i) % kCapacity]; }
  const PoseSample& sample(size_t i) const { return ring_[(begin_ + i) % kCapacity]; }
  Eigen::Vector3d pivotOf(const Pose& pose, size_t slot) const;
  Pose poseOf(const Eigen::Vector3d& pivot, const Eigen::Quaterniond& rotation, size_t slot) const;
  bool isJudged(size_t slot) const { return !slots_.carrier || *slots_.carrier == slot; }
  /// Whether the motion jumps between sample i - 1 and sample i.
  bool isCut(size_t i) const;
  /// Whether the motion between sample i - 1 and sample i is known.
  bool isJoined(size_t i) const;
  bool isCutSinceLastStep(size_t base) const;
  /// Adds the derivative at sample i, times `factor` s, from samples before it. False where none is known.
  bool addTangent(Blend& blend, size_t i, int64_t least_spacing, double factor) const;
  Reading read(int64_t time, int64_t tolerance, PoseSample& out) const;
  void apply(const Blend& blend, size_t base, bool with_numbers, PoseSample& out) const;
  /// Begins to rejoin from what was shown at `start`, where the samples' motion was at `from`. False where
  /// that is too far.
  bool rejoin(const PoseSample& from, int64_t start, int64_t step);
  /// Adds what is left of the offsets to out_. False where nothing is.
  bool addOffsets(int64_t time);

  Slots slots_;
  double extrapolate_;
  std::vector<PoseSample> ring_;  ///< kCapacity samples
  /// Those in use, by epoch, then time. A new epoch hides what the one before has of later times.
  size_t begin_ = 0, size_ = 0;
  Step step_;
  PoseSample out_, then_;
  int64_t time_ = 0;            ///< of the last step
  int64_t reach_ = kNever;      ///< up to which the last step took samples
  int64_t base_time_ = kNever;  ///< of the last step's base sample
  bool is_held_ = false;        ///< the last step had no newer sample
  bool is_fresh_ = false;       ///< a sample has come since
  int64_t held_ns_ = 0;         ///< for which steps have been held by one sample
  std::vector<Offset> offsets_;
  std::vector<float> number_offsets_;         ///< of scales, then weights
  int64_t rejoin_start_ = 0, rejoin_ns_ = 0;  ///< duration; 0: there are no offsets
};

}  // namespace strandcast
