#pragma once
#include <vector>

#include "air/air_system.h"
#include "core/backend.h"

namespace strandcast {

/// Every backend this program knows, runnable here or not. Where `wanted` names a CPU backend, the GPU
/// backend is neither listed nor queried, and STRANDCAST_GPU has no effect. Throws Error as gpuBackendInfo().
std::vector<BackendInfo> knownBackends(const std::string& wanted = "auto");
/// The air system for the named backend; `threads` of the simd backend, 0 = all.
AirFactory airOf(const std::string& backend, int threads = 0);

}  // namespace strandcast
