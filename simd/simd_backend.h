#pragma once
#include <string>
#include <vector>

#include "core/backend.h"

namespace strandcast {

/// One strand per SIMD lane, blocks of strands over threads. The instruction set is the best that this
/// program was compiled for and the machine has, or the one forced by `target`. Any number of threads gives
/// the same bits.
std::unique_ptr<Backend> makeSimdBackend(int threads = 0, const std::string& target = "");
/// Instruction sets that can run here, best first, e.g. "AVX3", "AVX2", "SSE4".
std::vector<std::string> simdTargets();
BackendInfo simdBackendInfo();

}  // namespace strandcast
