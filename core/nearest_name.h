#pragma once
#include <span>
#include <string>

namespace strandcast {

/// Suggestion "did you mean 'wind'?": the entry of `names` with the fewest single-character edits to `name`
/// (Levenshtein 1966), the first one of several. Empty if none is near.
std::string didYouMean(const std::string& name, std::span<const std::string> names);

}  // namespace strandcast
