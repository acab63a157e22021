#pragma once
#include "core/geometry.h"

namespace strandcast {

/// Throws Error, naming `where`, unless the position is finite and within kFarthestPose of the origin on each
/// axis and the rotation is a unit quaternion to kUnitTolerance. Does not allocate when all is well.
void checkPose(const Pose& pose, const char* where);

constexpr float kFarthestPose = 1e4f;    ///< m: beyond it a float does not tell a millimetre
constexpr float kUnitTolerance = 1e-3f;  ///< of a rotation's length

}  // namespace strandcast
