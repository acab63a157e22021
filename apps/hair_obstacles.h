#pragma once
#include <vector>

#include "render/hair_bodies.h"
#include "transport/messages.h"

namespace strandcast {

/// What a renderer keeps grown hair out of: `colliders`, what the daemon's guides collide with. Where there
/// are none (null or empty: a recording, say), or one came without its field, the distance field of the
/// published body, in one part that follows the head and one that stays; it is baked with a progress bar and
/// kept in the user's cache. Nothing, with a warning, for a body that no field can be baked of. Ctrl-C stops
/// it: BakeStopped.
std::vector<HairObstacle> hairObstacles(const ColliderSet* colliders, const BodyDescription& body);

}  // namespace strandcast
