#pragma once
#include <vector>

#include "render/hair_bodies.h"
#include "transport/messages.h"

namespace strandcast {

/// What a renderer keeps grown hair out of: the distance field of the published body, in one part that
/// follows the head and one that stays. Baked with a progress bar and kept in the user's cache. Nothing, with
/// a warning, for a body that no field can be baked of. Ctrl-C stops it: BakeStopped.
std::vector<HairObstacle> hairObstacles(const BodyDescription& body);

}  // namespace strandcast
