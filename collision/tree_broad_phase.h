#pragma once
#include "core/broad_phase.h"

namespace strandcast {

/// FCL's dynamic tree of boxes: for many bodies. Built when their number changes, refitted otherwise.
std::unique_ptr<BroadPhase> makeTreeBroadPhase();

}  // namespace strandcast
