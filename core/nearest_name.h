#pragma once
#include <span>
#include <string>

namespace strandcast {

/// "did you mean 'wind'?" of the one of `names` that takes the fewest single-character edits to become `name`
/// (Levenshtein 1966), the first of several; empty where none is near.
std::string didYouMean(const std::string& name, std::span<const std::string> names);

}  // namespace strandcast
