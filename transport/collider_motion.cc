#include "transport/collider_motion.h"

#include <algorithm>
#include <cmath>

#include "transport/extrapolation.h"

namespace strandcast {
namespace {

using Rotation = Eigen::Quaterniond;
using Vector = Eigen::Vector3d;

/// `last`, moved on by `times` the screw motion (rotation about an axis in space, and translation along it)
/// from `before` to it.
Pose movedOn(const Pose& before, const Pose& last, double times) {
  constexpr double kNoTurn = 1e-6;  // rad; below it the motion is a translation
  if (before.position == last.position && before.rotation.coeffs() == last.rotation.coeffs()) return last;
  const Rotation from = before.rotation.cast<double>().normalized(),
                 to = last.rotation.cast<double>().normalized();
  const Vector place = last.position.cast<double>();
  Rotation turn = to * from.conjugate();
  if (turn.w() < 0) turn.coeffs() *= -1;  // shortest rotation
  const Vector way = place - turn * before.position.cast<double>();
  const double angle = 2 * std::atan2(turn.vec().norm(), turn.w());
  Rotation rotation = to;
  Vector position = place + times * (place - before.position.cast<double>());
  if (angle > kNoTurn) {
    const Vector axis = turn.vec().normalized(), along = way.dot(axis) * axis, across = way - along;
    const Vector middle = 0.5 * (across + axis.cross(across) / std::tan(0.5 * angle));
    const Rotation further(Eigen::AngleAxisd(times * angle, axis));
    rotation = (further * to).normalized();
    position = further * (place - middle) + middle + times * along;
  }
  const Pose pose{position.cast<float>(), rotation.cast<float>()};
  return pose.position.allFinite() && pose.rotation.coeffs().allFinite() ? pose : last;
}

}  // namespace

void ColliderMotion::clear() {
  last_.clear();
  before_.clear();
}

void ColliderMotion::learn(std::span<const PlacedCollider> placed, double time) {
  std::swap(before_, last_);
  before_time_ = last_time_;
  last_.assign(placed.begin(), placed.end());
  last_time_ = time;
}

void ColliderMotion::extrapolate(double time, std::vector<PlacedCollider>& out) const {
  out.assign(last_.begin(), last_.end());
  const double times = extrapolation(before_time_, last_time_, time);
  if (times == 0) return;
  for (PlacedCollider& placed : out) {
    const auto known = std::find_if(before_.begin(), before_.end(),
                                    [&](const PlacedCollider& before) { return before.id == placed.id; });
    if (known != before_.end()) placed.pose = movedOn(known->pose, placed.pose, times);
  }
}

}  // namespace strandcast
