#pragma once
#include <vector>

#include "air/air_maker.h"
#include "core/backend.h"

namespace strandcast {

/// Every backend this program knows of, runnable here or not.
std::vector<BackendInfo> knownBackends();
/// How the backend of that name does the work of air; `threads` of the simd backend, 0 = all.
AirMaker airOf(const std::string& backend, int threads = 0);

}  // namespace strandcast
