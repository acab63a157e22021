#pragma once
#include <string>
#include <vector>

#include "apps/settings.h"

namespace strandcast {

/// Checks for settings that others make void, by the tables in unused_settings.cc. A setting is reported at
/// its origin, an option or a file: see Settings::given. A refused setting of a file gives way where an
/// option makes it void, and is then reported as a note.
///
/// Throws Error for the first refused setting, naming its origin and the remedy. Returns a line for each of
/// the others. `any_solver`: skips the rules about one solver, because the program runs several.
std::vector<std::string> checkUnusedSettings(const Settings& settings, bool any_solver = false);

/// The network rules alone, for programs with only the options of addNetworkOptions().
void checkUnusedNetworkSettings(const Settings& settings);

/// The condition under which a parameter has an effect, "it needs wind_grid=1"; empty where it always has.
std::string conditionOf(const std::string& name);
/// That condition where it is not met by `parameters`; empty otherwise.
std::string unmetConditionOf(const Parameters& parameters, const std::string& name);

}  // namespace strandcast
