#include "validation/case.h"

#include <fmt/format.h>

#include <cmath>

namespace strandcast {
namespace {

Case scored(const Quantity& quantity, double measured, double truth, double error, double limit,
            const std::string& error_unit) {
  return {quantity.name, quantity.quantity, quantity.unit,  measured, truth, error,
          limit,         error_unit,        error <= limit, ""};
}

}  // namespace

std::vector<std::string> caseNames(std::string_view pattern, std::span<const double> values) {
  std::vector<std::string> names;
  for (const double value : values) names.push_back(fmt::format(fmt::runtime(pattern), value));
  return names;
}

double worse(double a, double b) { return std::isnan(a) || a > b ? a : b; }

Case relativeCase(const Quantity& quantity, double measured, double truth, double limit_percent) {
  return scored(quantity, measured, truth, 100 * std::fabs(measured / truth - 1), limit_percent, "%");
}

Case absoluteCase(const Quantity& quantity, double measured, double truth, double limit) {
  return scored(quantity, measured, truth, std::fabs(measured - truth), limit, quantity.unit);
}

Case atLeastCase(const Quantity& quantity, double measured, double truth, double limit) {
  const double error = measured >= truth ? 0 : truth - measured;
  return scored(quantity, measured, truth, error, limit, quantity.unit);
}

}  // namespace strandcast
