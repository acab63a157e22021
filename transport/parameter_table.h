#pragma once
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/parameters.h"
#include "transport/messages.h"

namespace strandcast {

/// Parameters by name, with their components.
using NamedValues = std::vector<std::pair<std::string, std::vector<double>>>;

/// What a status may tell.
inline constexpr size_t kMaxToldParameters = 256, kMaxToldComponents = 64, kMaxToldValues = 1024,
                        kMaxToldNames = 8192;  // bytes

/// Names without spaces; values are rounded to floats.
ParameterTable parameterTable(const NamedValues& values);
/// All of parameterList().
ParameterTable parameterTable(const Parameters& parameters);

/// Behind the parameters a table tells of what else commands steer, each by "KIND:NAME": docs/wire.md,
/// "Status".
inline constexpr const char *kToldSource = "fan", *kToldCollider = "collider", *kToldVoid = "void";
/// How a name of any bytes but control characters stands among others with a space between two: with spaces
/// and % written as %20 and %25.
std::string withoutSpaces(const std::string& name);
std::string withSpaces(std::string_view text);
/// False, and nothing is added, where it would not fit the wire any more. The name is written
/// withoutSpaces().
bool tell(ParameterTable& table, const std::string& kind, const std::string& name,
          const std::vector<double>& values);
/// Those of a kind, by their names alone; of "" the parameters.
NamedValues toldOf(const ParameterTable& table, const std::string& kind);

/// A table that fits the wire: names and values as many as it says, each name once, finite values.
bool isSound(const ParameterTable& table);
/// All of a sound table, in its order.
NamedValues namedValues(const ParameterTable& table);

}  // namespace strandcast
