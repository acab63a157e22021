// The transfer functions of sRGB (IEC 61966-2-1): stored values of pictures, and light. Both are 0 to 1.
#pragma once
#include <cmath>

namespace strandcast {

/// The stored value of linear light.
template <class Real>
Real srgbOf(Real linear) {
  return linear <= Real(0.0031308) ? Real(12.92) * linear
                                   : Real(1.055) * std::pow(linear, 1 / Real(2.4)) - Real(0.055);
}

/// The linear light of a stored value: the inverse.
template <class Real>
Real linearOf(Real srgb) {
  return srgb <= Real(0.04045) ? srgb / Real(12.92) : std::pow((srgb + Real(0.055)) / Real(1.055), Real(2.4));
}

}  // namespace strandcast
