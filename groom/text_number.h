#pragma once
#include <optional>
#include <string_view>

namespace strandcast {

/// The decimal number that the whole text is, with or without a sign; 0 where it is too small for a double,
/// none where it is too large.
std::optional<double> numberOf(std::string_view text);
/// The same, infinite where it is too large for a double.
std::optional<double> numberOrInfinite(std::string_view text);

}  // namespace strandcast
