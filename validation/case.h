#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace strandcast {

/// One quantity, measured and held against its truth.
struct Case {
  std::string name;
  std::string quantity;
  std::string unit;  ///< of `measured` and `truth`; empty for pure numbers
  double measured = 0;
  double truth = 0;
  double error = 0;        ///< of the measured against the truth, 0 or more
  double limit = 0;        ///< the largest error that passes
  std::string error_unit;  ///< of `error` and `limit`: "%" of the truth, or an absolute unit
  bool passed = false;     ///< error <= limit; never where something is not a number
  std::string note;        ///< what else there is to know; may be empty
};

/// What is measured, before it is.
struct Quantity {
  std::string name;  ///< of the case
  std::string quantity;
  std::string unit;
};

/// Names of one case per value: `pattern` has {:g} where the value goes.
std::vector<std::string> caseNames(std::string_view pattern, std::span<const double> values);

/// The larger error; not a number where either is.
double worse(double a, double b);

/// Error in percent of the truth.
Case relativeCase(const Quantity& quantity, double measured, double truth, double limit_percent);
/// Error in the unit of the quantity.
Case absoluteCase(const Quantity& quantity, double measured, double truth, double limit);
/// A measured value of `truth` or more is right.
Case atLeastCase(const Quantity& quantity, double measured, double truth, double limit);

}  // namespace strandcast
