#include "io/text_number.h"

#include <algorithm>
#include <charconv>
#include <limits>

namespace strandcast {
namespace {

/// Of a number out of the range of a double: whether its magnitude is too small, not too large.
bool isTiny(std::string_view number) {
  const size_t mantissa = std::min(number.find_first_of("eE"), number.size());
  const std::string_view digits = number.substr(0, mantissa), power = number.substr(mantissa);
  const bool is_signed = power.size() > 1 && (power[1] == '+' || power[1] == '-');
  const std::string_view size = power.substr(std::min<size_t>(power.size(), is_signed ? 2 : 1));
  double exponent = 0;
  if (std::from_chars(size.data(), size.data() + size.size(), exponent).ec == std::errc::result_out_of_range)
    exponent = std::numeric_limits<double>::infinity();
  if (is_signed && power[1] == '-') exponent = -exponent;
  const auto point = static_cast<double>(std::min(digits.find('.'), digits.size()));
  return exponent + point - static_cast<double>(digits.find_first_of("123456789")) < 0;
}

}  // namespace

std::optional<double> numberOf(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool sound = failure == std::errc() || (failure == std::errc::result_out_of_range && isTiny(text));
  if (!sound || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::optional<double> numberOrInfinite(std::string_view text) {
  if (const std::optional<double> number = numberOf(text)) return number;
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (failure != std::errc::result_out_of_range || end != text.data() + text.size()) return std::nullopt;
  return text.starts_with('-') ? -std::numeric_limits<double>::infinity()
                               : std::numeric_limits<double>::infinity();
}

}  // namespace strandcast
