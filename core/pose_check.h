#pragma once
#include "core/geometry.h"

namespace strandcast {

/// Throws Error, naming `where`, unless the position is finite and within kFarthestPose of the origin on each
/// axis and the rotation is a unit quaternion to kUnitTolerance. Allocates only to throw.
void checkPose(const Pose& pose, const char* where);

constexpr float kFarthestPose = 1e4f;    ///< m: beyond it a float does not resolve a millimetre
constexpr float kUnitTolerance = 1e-3f;  ///< on a rotation's norm

}  // namespace strandcast
