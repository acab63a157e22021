#pragma once
#include <optional>
#include <string>
#include <vector>

#include "core/backend.h"

namespace strandcast {

/// Strands on OpenGL 4.5 compute shaders: without bodies a step is one or two dispatches per group of strands
/// of like size, with all its substeps; among bodies each substep is several. The first step with a solver,
/// and its first with bodies, compile their programs and may throw Error. Makes its own headless context;
/// throws Error when there is none. `few_vertices`: strands of so many in all, and of two thirds of it among
/// bodies, the rod does with one program; more with one for calm strands and then one for violent ones.
/// Nothing comes out otherwise. Empty = what is best on an H100.
std::unique_ptr<Backend> makeGpuBackend(std::optional<size_t> few_vertices = {});
/// Not available where there is no context, or on a driver that gpu_compute/driver_faults.h knows. Throws
/// Error where STRANDCAST_GPU names a device that has none.
BackendInfo gpuBackendInfo();

/// A device that STRANDCAST_GPU may name: see gl/context.h.
struct GpuListing {
  int number = 0;
  std::string device;  ///< GL_RENDERER, or why it has no context
  std::string uuid;    ///< as `nvidia-smi -L` prints it, without "GPU-"; empty where the driver has none
};
/// All of this machine; empty where the program is built without OpenGL. Makes a context on each in turn.
std::vector<GpuListing> gpuList();

}  // namespace strandcast
