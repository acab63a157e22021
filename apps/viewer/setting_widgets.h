#pragma once
#include <string>
#include <vector>

#include "core/parameters.h"

namespace strandcast {

/// One row of the panel that is being made: name, value, unit, help under the mouse, and a button back to
/// `usual` where the value is another. Gives whether it was changed, in range.
bool settingRow(const ParameterInfo& info, const std::vector<std::string>& choices,
                const std::vector<double>& usual, std::vector<double>& values);
/// The same for a text that Enter ends.
bool textRow(const std::string& name, const std::string& help, std::string& text);
/// Help under the mouse for what was drawn last.
void helpHere(const std::string& text);

}  // namespace strandcast
