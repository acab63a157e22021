#pragma once
#include <algorithm>

namespace strandcast {

/// 0 to 1 over [0, 1], with no slope at both ends, and as there beyond them.
template <class Real>
Real smoothStep(Real t) {
  t = std::clamp(t, Real(0), Real(1));
  return t * t * (3 - 2 * t);
}

/// The part that is gone, after `seconds`, of a way that takes `of` s.
inline double partGone(double seconds, double of) { return smoothStep(of > 0 ? seconds / of : 1.0); }

}  // namespace strandcast
