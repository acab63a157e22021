#pragma once
#include <string>

#include "scenes/head_motion.h"

namespace strandcast {

/// Where a daemon's head goes, as commands and the scene have set it: as data, so that another daemon can
/// take it over.
struct SteeredHead {
  enum class Kind {
    kScene,  ///< the scene's own motion
    kNamed,  ///< over from `from` to the procedural motion `name`
    kPose    ///< over from `from` to `to`, and still
  };
  Kind kind = Kind::kScene;
  std::string name;
  Pose from, to;
  double start = 0;  ///< s of simulation time

  bool operator==(const SteeredHead& other) const;
};

/// Of seconds since course.start. `scene` is the scene's own; procedural motions turn about `pivot`. Throws
/// Error on a name of no motion.
HeadMotion motionOf(const SteeredHead& course, const HeadMotion& scene, const Vec3& pivot);

/// From one pose to another and then still, with no jump in velocity.
Pose onTheWay(const Pose& from, const Pose& to, double seconds, double of);

}  // namespace strandcast
