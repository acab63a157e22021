#pragma once
#include <vector>

#include "render/hair_bodies.h"
#include "transport/messages.h"

namespace strandcast {

/// The obstacles that a renderer keeps grown hair out of. They are `colliders`, the bodies that the daemon's
/// guides collide with. Where there are none (null or empty, as for a recording), or one lacks its field, the
/// published body replaces or completes them. It is baked as distance fields of two parts: one follows the
/// head, one stays. The bake shows a progress bar and uses the user's cache. Empty, with a warning, for a
/// body that no field can be baked of. Ctrl-C stops it: throws BakeStopped.
std::vector<HairObstacle> hairObstacles(const ColliderSet* colliders, const BodyDescription& body);

}  // namespace strandcast
