#pragma once
#include "apps/settings.h"

namespace strandcast {

/// The scene on the backend and with the solver and parameters of `settings`; a rod's rest strains are made
/// sag-free unless the settings say otherwise. Logs what time and memory that takes where it is worth saying
/// (apps/hair_outlook.h), and what had to be stiffened. With a progress bar; Ctrl-C ends it: Interrupted.
/// Throws Error.
Simulation makeSimulation(const Scene& scene, const Settings& settings);

}  // namespace strandcast
