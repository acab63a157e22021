#pragma once
#include <string>
#include <vector>

#include "core/backend.h"

namespace strandcast {

/// One strand per SIMD lane, blocks of strands over threads. `threads`: 0 (all) to 4096; the result does not
/// depend on it, bit for bit. `target`: one of simdTargets(), empty: the best. Throws Error for other values.
std::unique_ptr<Backend> makeSimdBackend(int threads = 0, const std::string& target = "");
/// Instruction sets that this program was compiled for and the machine can run, best first, e.g. "AVX3",
/// "AVX2", "SSE4".
std::vector<std::string> simdTargets();
BackendInfo simdBackendInfo();

}  // namespace strandcast
