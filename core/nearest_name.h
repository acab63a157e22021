#pragma once
#include <span>
#include <string>

namespace strandcast {

/// The one of `names` (at least one) that takes the fewest single-character edits to become `name`
/// (Levenshtein 1966), for "did you mean"; the first of several.
std::string nearestName(const std::string& name, std::span<const std::string> names);

}  // namespace strandcast
