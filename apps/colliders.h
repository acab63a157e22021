#pragma once
#include <vector>

#include "core/simulation.h"
#include "transport/messages.h"

namespace strandcast {

/// The bodies of a simulation that have shapes, as renderers know them.
std::vector<Collider> collidersOf(const Simulation& simulation);
/// Where those are that do not follow the head.
std::vector<PlacedCollider> placedColliders(const Simulation& simulation);

}  // namespace strandcast
