#pragma once
#include <limits>
#include <string>

namespace CLI {
class Validator;
}

namespace strandcast {

/// The numbers that are valid for a user's input. All text input of numbers is parsed here: options, the
/// arguments of `ctl`, --set, --material. TOML files have typed numbers, whose range is checked here too.
struct NumberRange {
  double low = -std::numeric_limits<double>::infinity();  ///< inclusive, as is `high`
  double high = std::numeric_limits<double>::infinity();
  bool whole = false;
  std::string unit{};

  /// "a number", "a number from 1 to 1000 Hz", "a whole number from 0 to 232".
  std::string text() const;
  /// False for NaN and infinities.
  bool contains(double value) const;
};

/// Parses a decimal number as numberOf() of io/text_number.h does in every locale: no "inf", "nan", "0x10"
/// or "1,5", no text around it. Throws Error, `'abc' is not a number from 1 to 1000 Hz: where; remedy`.
double numberIn(const std::string& text, const NumberRange& range, const std::string& where,
                const std::string& remedy = "");

/// The same check for an option's text, for check() or, of whole numbers, for transform(). The transform
/// replaces "1e3" by "1000", because CLI11 does not read exponents into integers.
CLI::Validator inRange(const NumberRange& range);
/// inRange() for finite numbers from `low` to `high`.
CLI::Validator finiteRange(double low, double high, const std::string& unit = "");
/// inRange() for whole numbers, for transform().
CLI::Validator wholeRange(double low, double high);

}  // namespace strandcast
