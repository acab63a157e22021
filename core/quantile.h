#pragma once
#include <algorithm>
#include <cstddef>
#include <vector>

namespace strandcast {

/// Quantile: smallest of `values` below which the fraction `part` of them lies, 0 to 1. 0 without values.
inline double quantileOf(std::vector<double> values, double part) {
  if (values.empty()) return 0;
  const size_t place =
      std::min(values.size() - 1, static_cast<size_t>(part * static_cast<double>(values.size())));
  const auto at = values.begin() + static_cast<ptrdiff_t>(place);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace strandcast
