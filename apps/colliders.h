#pragma once
#include <vector>

#include "core/simulation.h"
#include "transport/messages.h"

namespace strandcast {

/// The simulation's bodies that have shapes, in the form that renderers receive.
std::vector<Collider> collidersOf(const Simulation& simulation);
/// Poses of the bodies that do not follow the head.
std::vector<PlacedCollider> placedColliders(const Simulation& simulation);

}  // namespace strandcast
