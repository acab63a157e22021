#pragma once
#include <optional>

#include "core/backend.h"

namespace strandcast {

/// Strands on OpenGL 4.5 compute shaders: without bodies a step is one or two dispatches per group of strands
/// of like size, with all its substeps; among bodies each substep is several. The first step with a solver,
/// and its first with bodies, compile their programs and may throw Error. Makes its own headless context;
/// throws Error when there is none. `few_vertices`: strands of so many in all, and of two thirds of it among
/// bodies, the rod does with one program; more with one for calm strands and then one for violent ones.
/// Nothing comes out otherwise. Empty = what is best on an H100.
std::unique_ptr<Backend> makeGpuBackend(std::optional<size_t> few_vertices = {});
BackendInfo gpuBackendInfo();

}  // namespace strandcast
