#pragma once
#include "apps/settings.h"

namespace strandcast {

/// Builds the scene on the backend and with the solver and parameters of `settings`. A rod's rest strains are
/// made sag-free unless the settings say otherwise. Logs the estimated time and memory where they are large
/// (apps/hair_estimate.h), and the strands that had to be stiffened. Shows a progress bar; Ctrl-C throws
/// Interrupted. Throws Error.
Simulation makeSimulation(const Scene& scene, const Settings& settings);

}  // namespace strandcast
