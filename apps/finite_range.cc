#include "apps/finite_range.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

namespace strandcast {

CLI::Validator finiteRange(double low, double high) {
  const auto refuse = [low, high](const std::string& text) {
    double value = 0;
    if (CLI::detail::lexical_cast(text, value) && value >= low && value <= high) return std::string();
    return fmt::format("Value {} not in range [{:g} - {:g}]", text, low, high);
  };
  return {refuse, fmt::format("FLOAT in [{:g} - {:g}]", low, high)};
}

}  // namespace strandcast
