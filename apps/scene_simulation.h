#pragma once
#include "apps/settings.h"

namespace strandcast {

/// The scene on the backend and with the solver and parameters of `settings`; a rod's rest strains are made
/// sag-free unless the settings say otherwise. Logs what had to be stiffened for that. Throws Error.
Simulation makeSimulation(const Scene& scene, const Settings& settings);

}  // namespace strandcast
