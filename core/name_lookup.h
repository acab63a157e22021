// Look-up of names that users give, with errors that say which names there are.
#pragma once
#include <span>
#include <string>

#include "core/error.h"

namespace strandcast {

/// Entry of `list` with this `name`. Otherwise throws Error with the unknown name, `where`, and all known
/// names.
template <class List>
const auto& namedEntry(const List& list, const std::string& what, const std::string& name,
                       const std::string& where) {
  std::string names;
  for (const auto& entry : list) {
    if (name == entry.name) return entry;
    names += (names.empty() ? "" : ", ") + std::string(entry.name);
  }
  throw Error("unknown " + what + " '" + name + "'", where, "choose one of " + names);
}

/// Suggestion "did you mean 'wind'?": the entry of `names` with the fewest single-character edits to `name`
/// (Levenshtein 1966), the first one of several. Empty if none is near.
std::string didYouMean(const std::string& name, std::span<const std::string> names);

}  // namespace strandcast
