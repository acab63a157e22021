#pragma once
#include <string>
#include <vector>

#include "core/geometry.h"
#include "transport/messages.h"

namespace strandcast {

/// A command's name in errors, in the words of `strandcast ctl`: "strandcast ctl collider move rod".
std::string commandText(const Command& command);
/// Reads a pose from a command's values at `first`: position x y z (m, each within kFarthestPlace), rotation
/// x y z w (length 0.5 to 1.5, then normalised). Precondition: values has first + 7 elements. Throws Error,
/// naming `where`.
Pose commandedPose(const std::vector<double>& values, size_t first, const std::string& where);

}  // namespace strandcast
