#pragma once
#include <string>
#include <vector>

#include "apps/settings.h"

namespace strandcast {

/// Settings that others make void, by the rules of one table (void_settings.cc). A setting is looked at where
/// it was given, by option or by file: see Settings::given. A refused setting that a file has gives way where
/// an option is what makes it void, and is told of.
///
/// Throws Error for the first that is refused, naming its place and what to do. Gives a line for each of the
/// others. `any_solver`: rules about one solver do not hold, because the program runs several.
std::vector<std::string> checkVoidSettings(const Settings& settings, bool any_solver = false);

/// The same rules of the network alone: for programs with the options of addNetworkOptions() and no others.
void refuseVoidNetwork(const Settings& settings);

/// What a parameter needs that others may make void, "it needs wind_grid=1"; empty of one that none does.
std::string needOf(const std::string& name);
/// The same where it does nothing beside the others, or empty.
std::string whyVoid(const Parameters& parameters, const std::string& name);

}  // namespace strandcast
