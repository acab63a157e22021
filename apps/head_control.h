#pragma once
#include <string>

#include "scenes/head_motion.h"

namespace strandcast {

/// The motion of a daemon's head as set by commands and the scene. Plain data, so that another daemon can
/// take it over.
struct HeadControl {
  enum class Kind {
    kScene,  ///< the scene's own motion
    kNamed,  ///< blends from `from` into the procedural motion `name`
    kPose    ///< moves from `from` to `to`, then stays
  };
  Kind kind = Kind::kScene;
  std::string name;
  Pose from, to;
  double start = 0;  ///< s of simulation time

  bool operator==(const HeadControl& other) const;
};

/// The motion as a function of seconds since control.start. `scene`: the scene's own motion; procedural
/// motions turn about `pivot`, m. Throws Error on an unknown motion.
HeadMotion motionOf(const HeadControl& control, const HeadMotion& scene, const Vec3& pivot);

/// The pose after `seconds` of a motion from one pose to another over `of` seconds, then still. Velocity is
/// continuous.
Pose poseBetween(const Pose& from, const Pose& to, double seconds, double of);

}  // namespace strandcast
