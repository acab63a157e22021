#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace strandcast {

/// One measured quantity, compared with its exact value.
struct Case {
  std::string name;
  std::string quantity;
  std::string unit;  ///< of `measured` and `truth`; empty for pure numbers
  double measured = 0;
  double truth = 0;
  double error = 0;        ///< of `measured` relative to `truth`, 0 or more
  double limit = 0;        ///< largest error that passes
  std::string error_unit;  ///< of `error` and `limit`: "%" of the truth, or an absolute unit
  bool passed = false;     ///< error <= limit; false where a number is NaN
  std::string note;        ///< further information; may be empty
};

/// What a case measures.
struct Quantity {
  std::string name;  ///< name of the case
  std::string quantity;
  std::string unit;
};

/// Names of cases, one per value: `pattern` has {:g} in place of the value.
std::vector<std::string> caseNames(std::string_view pattern, std::span<const double> values);

/// The larger of two errors; NaN where either is NaN.
double worse(double a, double b);

/// Error in percent of the truth.
Case relativeCase(const Quantity& quantity, double measured, double truth, double limit_percent);
/// Error in the unit of the quantity.
Case absoluteCase(const Quantity& quantity, double measured, double truth, double limit);
/// A measured value of at least `truth` has the error 0.
Case atLeastCase(const Quantity& quantity, double measured, double truth, double limit);

}  // namespace strandcast
