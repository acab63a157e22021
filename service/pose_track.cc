#include "service/pose_track.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "core/smooth_step.h"

namespace strandcast {
namespace {

using Eigen::Quaterniond, Eigen::Vector3d;

// Times in ns.
constexpr int64_t kMinRateTime = 10'000'000;  ///< of a rate: below it the noise of trackers shows
constexpr int64_t kLinear = 1'000'000;  ///< up to which a sample's motion goes on as if the next were here
/// Of the carrier from sample to sample, m/s and rad/s: what is faster is a jump. Times below 5 ms count as
/// 5 ms, because noise alone is as fast at 1 kHz.
constexpr double kFastest = 30, kFastestTurn = 60;
constexpr int64_t kMinCutTime = 5'000'000;
/// Of rejoining, s: longest without regard to the offset, longest of all; and speeds that it seldom exceeds.
constexpr double kUsualRejoin = 0.25, kLongestRejoin = 1, kRejoinSpeed = 2, kRejoinTurn = 6;
/// Offsets of the carrier beyond which the step is a cut, m and rad.
constexpr double kFarthestRejoin = 2, kFarthestRejoinTurn = 2 * EIGEN_PI / 3;

double seconds(int64_t ns) { return 1e-9 * static_cast<double>(ns); }

/// Rotation vector of the shorter way, rad.
Vector3d logarithm(const Quaterniond& q) {
  const double sine = q.vec().norm();
  if (sine < 1e-12) return Vector3d::Zero();
  const double sign = q.w() < 0 ? -1 : 1;
  return q.vec() * (sign * 2 * std::atan2(sine, sign * q.w()) / sine);
}

Quaterniond exponential(const Vector3d& turn) {
  const double angle = turn.norm();
  if (angle < 1e-12) return Quaterniond::Identity();
  return Quaterniond(Eigen::AngleAxisd(angle, turn / angle));
}

Vector3d turnBetween(const Pose& from, const Pose& to) {
  return logarithm(to.rotation.cast<double>() * from.rotation.cast<double>().conjugate());
}

/// Whether epoch a comes after epoch b, where both wrap (RFC 1982).
bool isLaterEpoch(uint32_t a, uint32_t b) { return static_cast<int32_t>(a - b) > 0; }

/// Calls `change(i, number...)` for each of the scales and weights of these samples.
template <class Change, class First, class... Others>
void forNumbers(Change change, First& first, Others&... others) {
  size_t i = 0;
  for (size_t slot = 0; slot < first.scales.size(); ++slot)
    for (int axis = 0; axis < 3; ++axis) change(i++, first.scales[slot][axis], others.scales[slot][axis]...);
  for (size_t k = 0; k < first.weights.size(); ++k) change(i++, first.weights[k], others.weights[k]...);
}

}  // namespace

PoseTrack::PoseTrack(Slots slots, double extrapolate) : slots_(std::move(slots)), extrapolate_(extrapolate) {
  PoseSample empty;
  empty.poses.resize(slots_.pivots.size());
  empty.scales.resize(slots_.has_scales ? slots_.pivots.size() : 0, Vec3::Ones());
  empty.weights.resize(slots_.weights);
  ring_.assign(kCapacity, empty);
  step_.shown = out_ = then_ = empty;
  offsets_.resize(slots_.pivots.size());
  number_offsets_.resize(3 * empty.scales.size() + slots_.weights);
}

PoseTrack::Arrival PoseTrack::add(const PoseSample& added) {
  const auto isBefore = [&](const PoseSample& other) {
    return other.epoch == added.epoch ? added.time_ns < other.time_ns
                                      : isLaterEpoch(other.epoch, added.epoch);
  };
  const auto isSame = [&](size_t i) {
    const PoseSample& other = sample(i);
    return other.epoch == added.epoch && (other.number == added.number || other.time_ns == added.time_ns);
  };
  size_t at = size_;
  while (at > 0 && isBefore(sample(at - 1))) --at;
  if ((at > 0 && isSame(at - 1)) || (at < size_ && isSame(at))) return Arrival::kRepeated;
  const bool is_late = added.time_ns <= reach_;
  if (is_late && (!is_held_ || added.time_ns <= base_time_) && added.epoch == step_.shown.epoch)
    return Arrival::kLate;
  if (size_ == kCapacity) {
    if (at == 0) return Arrival::kLate;
    begin_ = (begin_ + 1) % kCapacity;
    --size_;
    --at;
  }
  sample(size_) = added;
  for (size_t i = size_++; i > at; --i) std::swap(sample(i - 1), sample(i));
  is_fresh_ = true;
  return is_late ? Arrival::kLate : Arrival::kNew;
}

std::optional<int64_t> PoseTrack::nearest(int64_t time_ns) const {
  std::optional<int64_t> best;
  for (size_t i = 0; i < size_; ++i)
    if (!best || std::abs(sample(i).time_ns - time_ns) < std::abs(*best - time_ns)) best = sample(i).time_ns;
  return best;
}

Vector3d PoseTrack::pivotOf(const Pose& pose, size_t slot) const {
  return pose.rotation.cast<double>() * slots_.pivots[slot].cast<double>() + pose.position.cast<double>();
}

Pose PoseTrack::poseOf(const Vector3d& pivot, const Quaterniond& rotation, size_t slot) const {
  const Quaterniond unit = rotation.normalized();
  return {(pivot - unit * slots_.pivots[slot].cast<double>()).cast<float>(), Quat(unit.cast<float>())};
}

bool PoseTrack::isCut(size_t i) const {
  const PoseSample &a = sample(i - 1), &b = sample(i);
  if (a.epoch != b.epoch) return true;
  const double time = seconds(std::max(b.time_ns - a.time_ns, kMinCutTime));
  for (size_t slot = 0; slot < slots_.pivots.size(); ++slot) {
    if (!isJudged(slot)) continue;
    const Vector3d move = pivotOf(b.poses[slot], slot) - pivotOf(a.poses[slot], slot);
    if (move.norm() > kFastest * time) return true;
    if (turnBetween(a.poses[slot], b.poses[slot]).norm() > kFastestTurn * time) return true;
  }
  return false;
}

bool PoseTrack::isJoined(size_t i) const {
  return sample(i).time_ns - sample(i - 1).time_ns <= kLongestInterval && !isCut(i);
}

bool PoseTrack::isCutSinceLastStep(size_t base) const {
  if (sample(base).epoch != step_.shown.epoch) return true;
  for (size_t i = base; i > 0 && sample(i).time_ns > base_time_; --i)
    if (isCut(i)) return true;
  return false;
}

bool PoseTrack::addTangent(Blend& blend, size_t i, int64_t least_spacing, double factor) const {
  std::array<size_t, kTangentSamples> at{i};
  std::array<double, kTangentSamples> before{};  // s before sample i
  size_t count = 1;
  for (size_t j = i; j > 0 && count < kTangentSamples && isJoined(j); --j) {
    if (sample(at[count - 1]).time_ns - sample(j - 1).time_ns < least_spacing) continue;
    before[count] = seconds(sample(i).time_ns - sample(j - 1).time_ns);
    at[count++] = j - 1;
  }
  // Derivatives at sample i of Lagrange's polynomials through these samples; together they are 0.
  double own = 0;
  for (size_t j = 1; j < count; ++j) {
    double weight = -1 / before[j];
    for (size_t m = 1; m < count; ++m)
      if (m != j) weight *= before[m] / (before[m] - before[j]);
    blend.add(at[j], factor * weight);
    own -= weight;
  }
  blend.add(i, factor * own);
  return count > 1;
}

PoseTrack::Reading PoseTrack::read(int64_t time, int64_t tolerance, PoseSample& out) const {
  size_t after = size_;
  while (after > 0 && sample(after - 1).time_ns > time + tolerance) --after;
  Reading reading{.base = after > 0 ? after - 1 : 0};
  const PoseSample& base = sample(reading.base);
  const int64_t age = time - base.time_ns;
  Blend blend;
  if (std::abs(age) <= tolerance) {
    reading.is_exact = true;
  } else if (after > 0 && after < size_ && isJoined(after)) {
    const int64_t interval = sample(after).time_ns - base.time_ns;
    const double s = seconds(interval), u = seconds(age) / s;
    blend.add(after, u * u * (3 - 2 * u));
    // Samples closer than half the interval would make tangents of noise.
    if (!addTangent(blend, reading.base, interval / 2, s * u * (1 - u) * (1 - u)))
      blend.add(after, u * (1 - u) * (1 - u));  // along the chord
    addTangent(blend, after, interval / 2, -s * u * u * (1 - u));
  } else {
    reading.is_held = age > kLinear || age < 0;
    size_t first = reading.base;
    while (first > 0 && base.time_ns - sample(first).time_ns < kMinRateTime && isJoined(first)) --first;
    const double g = seconds(std::max<int64_t>(age, 0)),
                 rate_time = seconds(base.time_ns - sample(first).time_ns);
    const double moved = g < extrapolate_ ? g - g * g / (2 * extrapolate_) : extrapolate_ / 2;
    if (rate_time > 0) blend.add(first, -moved / rate_time);
  }
  out = base;
  if (blend.count > 0) apply(blend, reading.base, !reading.is_held, out);
  return reading;
}

void PoseTrack::apply(const Blend& blend, size_t base, bool with_numbers, PoseSample& out) const {
  const PoseSample& origin = sample(base);
  for (size_t slot = 0; slot < slots_.pivots.size(); ++slot) {
    const Vector3d pivot = pivotOf(origin.poses[slot], slot);
    Vector3d move = Vector3d::Zero(), turn = Vector3d::Zero();
    for (size_t i = 0; i < blend.count; ++i) {
      const Pose& other = sample(blend.terms[i].sample).poses[slot];
      move += blend.terms[i].weight * (pivotOf(other, slot) - pivot);
      turn += blend.terms[i].weight * turnBetween(origin.poses[slot], other);
    }
    out.poses[slot] =
        poseOf(pivot + move, exponential(turn) * origin.poses[slot].rotation.cast<double>(), slot);
  }
  if (!with_numbers) return;
  for (size_t i = 0; i < blend.count; ++i) {
    const auto weight = static_cast<float>(blend.terms[i].weight);
    forNumbers([&](size_t, float& number, float other, float own) { number += weight * (other - own); }, out,
               sample(blend.terms[i].sample), origin);
  }
}

bool PoseTrack::rejoin(const PoseSample& from, int64_t start, int64_t step) {
  double least = std::clamp(seconds(held_ns_), seconds(2 * step), std::max(kUsualRejoin, seconds(2 * step)));
  for (size_t slot = 0; slot < slots_.pivots.size(); ++slot) {
    const Pose &shown = step_.shown.poses[slot], &pose = from.poses[slot];
    Offset& offset = offsets_[slot];
    offset = {pivotOf(shown, slot) - pivotOf(pose, slot), turnBetween(pose, shown)};
    const double move = offset.move.norm(), turn = offset.turn.norm();
    if (isJudged(slot) && (move > kFarthestRejoin || turn > kFarthestRejoinTurn)) return false;
    least = std::max({least, move / kRejoinSpeed, turn / kRejoinTurn});
  }
  forNumbers([&](size_t i, float shown, float number) { number_offsets_[i] = shown - number; }, step_.shown,
             from);
  rejoin_start_ = start;
  rejoin_ns_ = std::llround(1e9 * std::min(least, kLongestRejoin));
  return true;
}

bool PoseTrack::addOffsets(int64_t time) {
  if (time - rejoin_start_ >= rejoin_ns_) rejoin_ns_ = 0;
  if (rejoin_ns_ == 0) return false;
  const double left =
      1 - smoothStep(static_cast<double>(time - rejoin_start_) / static_cast<double>(rejoin_ns_));
  for (size_t slot = 0; slot < slots_.pivots.size(); ++slot) {
    Pose& pose = out_.poses[slot];
    pose = poseOf(pivotOf(pose, slot) + left * offsets_[slot].move,
                  exponential(left * offsets_[slot].turn) * pose.rotation.cast<double>(), slot);
  }
  forNumbers([&](size_t i, float& number) { number += static_cast<float>(left) * number_offsets_[i]; }, out_);
  return true;
}

const PoseTrack::Step& PoseTrack::advance(int64_t time_ns, int64_t step_ns) {
  const bool is_first = step_.state == PoseState::kNone;
  step_.is_exact = step_.is_cut = false;
  if (size_ == 0) {
    if (!is_first) step_.state = PoseState::kResting;
    return step_;
  }
  const int64_t tolerance = step_ns / 100, before = time_ns - step_ns;
  const Reading now = read(time_ns, tolerance, out_);
  const int64_t base_time = sample(now.base).time_ns;
  const bool is_jump = std::abs(before - time_) > tolerance;
  const bool is_back = is_held_ && (is_fresh_ || base_time != base_time_);
  if (!is_first) {
    step_.is_cut = isCutSinceLastStep(now.base);
    if (!step_.is_cut && (is_jump || is_back)) {
      // Both at the end of the step before; but a motion that was unknown there is compared where it begins.
      const Reading then = read(before, tolerance, then_);
      const bool was_unknown = then.is_held && then.base != now.base;
      step_.is_cut = !rejoin(was_unknown ? out_ : then_, before, step_ns);
    }
    if (step_.is_cut) rejoin_ns_ = 0;
  }
  const bool rejoins = addOffsets(time_ns);
  const bool is_young = time_ns >= base_time && seconds(time_ns - base_time) < extrapolate_;
  step_.state = now.is_held ? (is_young ? PoseState::kExtrapolating : PoseState::kResting)
                            : (rejoins ? PoseState::kRejoining : PoseState::kLive);
  step_.is_exact = now.is_exact;
  held_ns_ = now.is_held ? step_ns + (base_time == base_time_ ? held_ns_ : 0) : 0;
  std::swap(step_.shown, out_);
  time_ = time_ns;
  reach_ = time_ns + tolerance;
  base_time_ = base_time;
  is_held_ = now.is_held;
  is_fresh_ = false;
  return step_;
}

}  // namespace strandcast
