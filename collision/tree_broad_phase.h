#pragma once
#include "core/broad_phase.h"

namespace strandcast {

/// FCL's dynamic AABB tree, for many bodies. Rebuilt when the number of bodies changes, refitted otherwise.
std::unique_ptr<BroadPhase> makeTreeBroadPhase();

}  // namespace strandcast
