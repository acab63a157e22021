#pragma once
#include <string>
#include <vector>

#include "core/parameters.h"

namespace strandcast {

/// Draws one row of the current panel: name, value, unit, help as a tooltip, and a button back to `usual`
/// where the value differs. Returns whether the value was changed, in range.
bool settingRow(const ParameterInfo& info, const std::vector<std::string>& choices,
                const std::vector<double>& usual, std::vector<double>& values);
/// The same for a text, which Enter confirms.
bool textRow(const std::string& name, const std::string& help, std::string& text);
/// A tooltip on the widget drawn last.
void helpHere(const std::string& text);

}  // namespace strandcast
