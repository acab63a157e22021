#pragma once
#include <limits>
#include <string>

namespace CLI {
class Validator;
}

namespace strandcast {

/// Which numbers a user may give for something. All texts of users become numbers here: options, the words of
/// `ctl`, --set, --material. Files in TOML have numbers already, which are checked here too.
struct NumberRange {
  double low = -std::numeric_limits<double>::infinity();  ///< in the range, as `high` is
  double high = std::numeric_limits<double>::infinity();
  bool whole = false;
  std::string unit{};

  /// "a number", "a number from 1 to 1000 Hz", "a whole number from 0 to 232".
  std::string text() const;
  /// Never one that is not finite.
  bool contains(double value) const;
};

/// Decimal numbers as numberOf() of groom/text_number.h reads them in every locale: no "inf", "nan", "0x10"
/// or "1,5", and nothing before or behind. Throws Error, `'abc' is not a number from 1 to 1000 Hz: where;
/// remedy`.
double numberIn(const std::string& text, const NumberRange& range, const std::string& where,
                const std::string& remedy = "");

/// The same check of an option's words, for check() or, of whole numbers, for transform(): that hands on
/// "1000" where "1e3" is given, which CLI11 does not read.
CLI::Validator inRange(const NumberRange& range);
/// inRange() of any finite number from `low` to `high`.
CLI::Validator finiteRange(double low, double high, const std::string& unit = "");
/// inRange() of whole numbers, for transform().
CLI::Validator wholeRange(double low, double high);

}  // namespace strandcast
