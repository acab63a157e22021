#pragma once
#include <string>
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

/// A table that fits the wire: names and values as many as it says, each name once, finite values.
bool isSound(const ParameterTable& table);
/// Of a sound table, in its order.
NamedValues namedValues(const ParameterTable& table);

}  // namespace strandcast
