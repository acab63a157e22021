#pragma once
#include "core/geometry.h"

namespace strandcast {

/// Excitation of a root: translation along X and rotation about Z, in phase.
struct Shake {
  double reach = 0.1;  ///< m, amplitude along X
  double shakes = 1;   ///< Hz, of the translation
  double turns = 1;    ///< Hz, of the rotation by 45 degrees
  double ramp = 0;     ///< s, smooth onset from rest; 0 = starts with a jump of the velocity
};

/// Pose of the root relative to rest, `time` s after the start.
Pose shakenRoot(double time, const Shake& shake = {});

}  // namespace strandcast
