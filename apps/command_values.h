#pragma once
#include <string>
#include <vector>

#include "core/geometry.h"
#include "transport/messages.h"

namespace strandcast {

/// What errors call a command by: how `strandcast ctl` gives it, "strandcast ctl collider move rod".
std::string commandText(const Command& command);
/// The pose that a command's values tell from `first` on: position x y z (m, each within kFarthestPlace),
/// rotation x y z w, which is 0.5 to 1.5 long and made a unit one. There are so many values. Throws Error,
/// naming `where`.
Pose commandedPose(const std::vector<double>& values, size_t first, const std::string& where);

}  // namespace strandcast
