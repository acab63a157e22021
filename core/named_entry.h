#pragma once
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

}  // namespace strandcast
