// The backends of this build, and the simulation of a scene on one of them.
#pragma once
#include <vector>

#include "air/air_system.h"
#include "core/backend.h"
#include "options/settings.h"

namespace strandcast {

/// Every backend this program knows, runnable here or not. Where `wanted` names a CPU backend, the GPU
/// backend is neither listed nor queried, and STRANDCAST_GPU has no effect. Throws Error as gpuBackendInfo().
std::vector<BackendInfo> knownBackends(const std::string& wanted = "auto");
/// The air system for the named backend; `threads` of the simd backend, 0 = all.
AirFactory airOf(const std::string& backend, int threads = 0);

/// Builds the scene on the backend and with the solver and parameters of `settings`. A rod's rest strains are
/// made sag-free unless the settings say otherwise. Logs the estimated time and memory where they are large
/// (options/scene_loading.h), and the strands that had to be stiffened. Shows a progress bar; Ctrl-C throws
/// Interrupted. Throws Error.
Simulation makeSimulation(const Scene& scene, const Settings& settings);

}  // namespace strandcast
