#pragma once
#include "core/backend.h"

namespace strandcast {

/// Strands on OpenGL 4.5 compute shaders: a step is one dispatch; a workgroup holds one strand or several
/// short ones, its invocations are their vertices. Makes its own headless context. Throws Error when there is
/// none.
std::unique_ptr<Backend> makeGpuBackend();
BackendInfo gpuBackendInfo();

}  // namespace strandcast
