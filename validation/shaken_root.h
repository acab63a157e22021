#pragma once
#include "core/geometry.h"

namespace strandcast {

/// How a root is shaken: along X and about Z, in phase.
struct Shake {
  double reach = 0.1;  ///< m, amplitude along X
  double shakes = 1;   ///< Hz, along X
  double turns = 1;    ///< Hz, about Z, by 45 degrees
  double ramp = 0;  ///< s over which it grows smoothly from rest; 0 = it starts with a jump of its velocity
};

/// Relative to rest, `time` seconds after the start.
Pose shakenRoot(double time, const Shake& shake = {});

}  // namespace strandcast
