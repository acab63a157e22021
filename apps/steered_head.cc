#include "apps/steered_head.h"

#include <utility>

#include "apps/command_limits.h"
#include "core/smooth_step.h"

namespace strandcast {
namespace {

bool isSame(const Pose& a, const Pose& b) {
  return a.position == b.position && a.rotation.coeffs() == b.rotation.coeffs();
}

HeadMotion rampTo(const Pose& from, const Pose& to) {
  return [=](double seconds) { return onTheWay(from, to, seconds, kRampSeconds); };
}

/// A motion that begins at the pose `from`, and not at rest.
HeadMotion rampInto(HeadMotion motion, const Pose& from) {
  return [motion = std::move(motion), way = rampTo(from, {})](double seconds) {
    return way(seconds) * motion(seconds);
  };
}

}  // namespace

bool SteeredHead::operator==(const SteeredHead& other) const {
  return kind == other.kind && name == other.name && start == other.start && isSame(from, other.from) &&
         isSame(to, other.to);
}

Pose onTheWay(const Pose& from, const Pose& to, double seconds, double of) {
  return interpolate(from, to, static_cast<float>(partGone(seconds, of)));
}

HeadMotion motionOf(const SteeredHead& course, const HeadMotion& scene, const Vec3& pivot) {
  switch (course.kind) {
    case SteeredHead::Kind::kNamed:
      return rampInto(proceduralMotion(course.name, pivot), course.from);
    case SteeredHead::Kind::kPose:
      return rampTo(course.from, course.to);
    case SteeredHead::Kind::kScene:
      break;
  }
  return scene;
}

}  // namespace strandcast
