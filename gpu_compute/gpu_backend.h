#pragma once
#include "core/backend.h"

namespace strandcast {

/// Strands on OpenGL 4.5 compute shaders: a step is one dispatch per group of strands of like size, with all
/// its substeps. The first step with a solver, and its first with bodies, compile their programs and may
/// throw Error. Makes its own headless context; throws Error when there is none.
std::unique_ptr<Backend> makeGpuBackend();
BackendInfo gpuBackendInfo();

}  // namespace strandcast
