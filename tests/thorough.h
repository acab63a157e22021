#pragma once
#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace strandcast {

inline constexpr const char* kSkippedUnlessThorough = "left to ./dev test --thorough (STRANDCAST_THOROUGH=1)";

/// Whether tests should also do what takes minutes and seldom finds what the others do not: `./dev test
/// --thorough`. Says so where they should not.
inline bool thorough() {
  const char* asked = std::getenv("STRANDCAST_THOROUGH");
  if (asked != nullptr && std::string_view(asked) == "1") return true;
  std::printf("[ left out ] %s\n", kSkippedUnlessThorough);
  return false;
}

}  // namespace strandcast
