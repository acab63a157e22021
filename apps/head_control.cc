#include "apps/head_control.h"

#include <utility>

#include "apps/command_limits.h"
#include "core/smooth_step.h"

namespace strandcast {
namespace {

bool isSame(const Pose& a, const Pose& b) {
  return a.position == b.position && a.rotation.coeffs() == b.rotation.coeffs();
}

HeadMotion rampTo(const Pose& from, const Pose& to) {
  return [=](double seconds) { return poseBetween(from, to, seconds, kRampSeconds); };
}

/// Blends from the pose `from` into a motion, over kRampSeconds.
HeadMotion rampInto(HeadMotion motion, const Pose& from) {
  return [motion = std::move(motion), way = rampTo(from, {})](double seconds) {
    return way(seconds) * motion(seconds);
  };
}

}  // namespace

bool HeadControl::operator==(const HeadControl& other) const {
  return kind == other.kind && name == other.name && start == other.start && isSame(from, other.from) &&
         isSame(to, other.to);
}

Pose poseBetween(const Pose& from, const Pose& to, double seconds, double of) {
  return interpolate(from, to, static_cast<float>(easedFraction(seconds, of)));
}

HeadMotion motionOf(const HeadControl& control, const HeadMotion& scene, const Vec3& pivot) {
  switch (control.kind) {
    case HeadControl::Kind::kNamed:
      return rampInto(proceduralMotion(control.name, pivot), control.from);
    case HeadControl::Kind::kPose:
      return rampTo(control.from, control.to);
    case HeadControl::Kind::kScene:
      break;
  }
  return scene;
}

}  // namespace strandcast
