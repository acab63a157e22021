#pragma once
// toml++ as all of the project includes it: 3.3 asserts on some malformed keys, and a file must never end the
// program.
#define TOML_HEADER_ONLY 1
#include <stdexcept>
#include <string>

[[noreturn]] inline void refuseMalformedToml() { throw std::invalid_argument("malformed text"); }
#define TOML_ASSERT(condition) ((condition) ? static_cast<void>(0) : refuseMalformedToml())
#define TOML_ASSERT_ASSUME(condition) TOML_ASSERT(condition)
#include <toml++/toml.h>

namespace strandcast {

/// Throws Error, naming `name` and the line, on what is not TOML.
toml::table parsedToml(const std::string& text, const std::string& name);

}  // namespace strandcast
