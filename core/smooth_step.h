#pragma once
#include <algorithm>

namespace strandcast {

/// Cubic smoothstep: 0 to 1 over [0, 1] with zero slope at both ends; clamped outside.
template <class Real>
Real smoothStep(Real t) {
  t = std::clamp(t, Real(0), Real(1));
  return t * t * (3 - 2 * t);
}

/// Eased fraction, 0 to 1, of a transition of `of` seconds after `seconds`; 1 if `of` is 0.
inline double easedFraction(double seconds, double of) { return smoothStep(of > 0 ? seconds / of : 1.0); }

}  // namespace strandcast
