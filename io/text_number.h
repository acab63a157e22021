#pragma once
#include <optional>
#include <string_view>

namespace strandcast {

/// Parses the whole text as a decimal number with an optional sign. 0 where its magnitude is too small for a
/// double; none where it is too large or the text is no number.
std::optional<double> numberOf(std::string_view text);
/// As numberOf(), but infinite where the magnitude is too large for a double.
std::optional<double> numberOrInfinite(std::string_view text);

}  // namespace strandcast
