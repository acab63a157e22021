#pragma once
#include <optional>
#include <string>
#include <vector>

#include "core/backend.h"

namespace strandcast {

/// Strands on OpenGL 4.5 compute shaders. Without bodies a step is one or two dispatches per group of
/// strands, each with all substeps; among bodies each substep is several dispatches. The first step with a
/// solver, and its first with bodies, compile shaders and may throw Error. Makes its own headless context;
/// throws Error if there is none.
///
/// `small_model_vertices`: a model of up to this many vertices (among bodies two thirds of it) is solved by
/// one variant of the rod. A larger model is solved by the variant without the dense metric, then its listed
/// strands by the one with it. Results differ by rounding at most. Empty: the best value for an H100.
std::unique_ptr<Backend> makeGpuBackend(std::optional<size_t> small_model_vertices = {});
/// Not available without a context, or on a driver that driverFault() refuses. Throws Error if
/// STRANDCAST_GPU names a device without a context.
BackendInfo gpuBackendInfo();

/// A device that STRANDCAST_GPU can select: see gl/context.h.
struct GpuListing {
  int number = 0;
  std::string device;  ///< GL_RENDERER, or why it has no context
  std::string uuid;    ///< as `nvidia-smi -L` prints it, without "GPU-"; empty if the driver has none
};
/// All devices of this machine; empty in a build without OpenGL. Makes a context on each in turn.
std::vector<GpuListing> gpuList();

}  // namespace strandcast
