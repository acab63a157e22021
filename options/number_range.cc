#include "options/number_range.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <optional>

#include "core/error.h"
#include "io/text_number.h"

namespace strandcast {
namespace {

std::string limitText(double limit, bool whole) {
  return whole ? fmt::format("{:.0f}", limit) : fmt::format("{:g}", limit);
}

std::string limitsText(const NumberRange& range) {
  return limitText(range.low, range.whole) + " to " + limitText(range.high, range.whole);
}

std::optional<double> numberWithin(const std::string& text, const NumberRange& range) {
  const std::optional<double> value = numberOf(text);
  return value && range.contains(*value) ? value : std::nullopt;
}

std::string refusalText(const std::string& text, const NumberRange& range) {
  return fmt::format("'{}' is not {}", text, range.text());
}

}  // namespace

std::string NumberRange::text() const {
  std::string out = whole ? "a whole number" : "a number";
  if (std::isfinite(low) && std::isfinite(high)) out += " from " + limitsText(*this);
  return unit.empty() ? out : out + ' ' + unit;
}

bool NumberRange::contains(double value) const {
  return std::isfinite(value) && value >= low && value <= high && (!whole || value == std::floor(value));
}

double numberIn(const std::string& text, const NumberRange& range, const std::string& where,
                const std::string& remedy) {
  if (const std::optional<double> value = numberWithin(text, range)) return *value;
  throw Error(refusalText(text, range), where, remedy);
}

CLI::Validator inRange(const NumberRange& range) {
  const auto read = [range](std::string& text) {
    const std::optional<double> value = numberWithin(text, range);
    if (!value) return refusalText(text, range);
    if (range.whole) text = fmt::format("{:.0f}", *value);
    return std::string();
  };
  return {read, std::isfinite(range.low) ? limitsText(range) : ""};
}

CLI::Validator finiteRange(double low, double high, const std::string& unit) {
  return inRange({low, high, false, unit});
}

CLI::Validator wholeRange(double low, double high) { return inRange({low, high, true}); }

}  // namespace strandcast
