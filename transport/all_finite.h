#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

namespace strandcast {

/// Whether all components of all vectors are finite: no NaN, no infinity.
template <class Vector>
bool allFinite(const std::vector<Vector>& vectors) {
  return std::all_of(vectors.begin(), vectors.end(), [](const Vector& v) { return v.allFinite(); });
}

/// Whether all values are finite: no NaN, no infinity.
inline bool allFinite(const std::vector<float>& values) {
  return std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); });
}

}  // namespace strandcast
