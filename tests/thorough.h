// What shortens tests: sanitizers, and runs that are not thorough.
#pragma once
#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace strandcast {

/// Whether a sanitizer makes this program several times slower than users have it.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

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
