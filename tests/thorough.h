#pragma once
#include <cstdlib>
#include <string_view>

namespace strandcast {

/// Whether tests should also do what takes minutes and seldom finds what the others do not: `./dev test
/// --thorough`. Those that leave something out without it say so.
inline bool thorough() {
  const char* asked = std::getenv("STRANDCAST_THOROUGH");
  return asked != nullptr && std::string_view(asked) == "1";
}
inline constexpr const char* kLeftToThorough = "left to ./dev test --thorough (STRANDCAST_THOROUGH=1)";

}  // namespace strandcast
