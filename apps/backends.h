#pragma once
#include <vector>

#include "air/air_maker.h"
#include "core/backend.h"

namespace strandcast {

/// Every backend this program knows of, runnable here or not. Where `wanted` is one that runs on the
/// processor, without that of the GPU, which is then not asked: STRANDCAST_GPU does not count. Throws Error
/// as gpuBackendInfo().
std::vector<BackendInfo> knownBackends(const std::string& wanted = "auto");
/// How the backend of that name does the work of air; `threads` of the simd backend, 0 = all.
AirMaker airOf(const std::string& backend, int threads = 0);

}  // namespace strandcast
