#include "service/pose_clock.h"

#include <algorithm>
#include <cstdlib>

namespace strandcast {
namespace {

constexpr int64_t kFar = kNsPerSecond / 2, kMinLockInterval = kNsPerSecond / 2;
constexpr int kFarArrivals = 8;

}  // namespace

void PoseClock::arrive(int64_t sender_ns, int64_t arrival_ns) {
  const int64_t second = arrival_ns / kNsPerSecond, difference = arrival_ns - sender_ns;
  const auto count = static_cast<int64_t>(seconds_.size());
  Second& now = seconds_[static_cast<size_t>(second % count)];
  if (now.second != second) now = {second, difference, 0};
  now.least = std::min(now.least, difference);
  offset_ = now.least;
  for (const Second& s : seconds_)
    if (s.second > second - count) offset_ = std::min(offset_, s.least);
  now.lateness = std::max(now.lateness, difference - offset_);
  lateness_ = 0;
  for (const Second& s : seconds_)
    if (s.second > second - count) lateness_ = std::max(lateness_, s.lateness);
}

int64_t PoseClock::wallOf(int64_t sender_ns, int64_t wait_ns, int64_t longest_ns) const {
  return sender_ns + offset_ + std::min(lateness_ + kNsPerMillisecond + wait_ns, longest_ns);
}

bool PoseLock::arrive(int64_t sender_ns, bool is_new_epoch, int64_t arrival_ns, int64_t step_end_ns) {
  const bool is_far = is_locked_ && std::abs(sender_ns - timeOf(step_end_ns)) > kFar;
  const int64_t offset = arrival_ns - sender_ns;
  is_foreign_ = is_far && std::abs(offset - offset_) > kFar;
  if (!is_foreign_) offset_ = offset;
  far_ = is_far ? far_ + 1 : 0;
  is_due_ = is_due_ || far_ >= kFarArrivals || (is_far && is_new_epoch);
  has_arrival_ = true;
  newest_ = sender_ns;
  arrival_ = arrival_ns;
  return !is_foreign_;
}

bool PoseLock::lockIfDue(int64_t step_end_ns, int64_t hold_ns) {
  const bool has_arrival = has_arrival_;
  has_arrival_ = false;
  if (!has_arrival || !is_due_ || (is_locked_ && arrival_ - locked_at_ < kMinLockInterval)) return false;
  delay_ = step_end_ns - newest_ + hold_ns;
  began_timeline_ = !is_locked_ || is_foreign_;
  offset_ = arrival_ - newest_;
  is_foreign_ = false;
  is_locked_ = true;
  ++locks_;
  is_due_ = false;
  far_ = 0;
  locked_at_ = arrival_;
  return true;
}

void PoseLock::followPhase(int64_t error_ns, int64_t step_ns) {
  delay_ += std::clamp(error_ns, -step_ns / 200, step_ns / 200);
}

void PoseLock::takePhase(int64_t error_ns, int64_t step_ns) {
  if (std::abs(error_ns) <= step_ns / 2) delay_ += error_ns;
}

}  // namespace strandcast
