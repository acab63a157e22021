#pragma once
#include <cmath>
#include <vector>

#include "core/geometry.h"

namespace strandcast {

/// A weightless inextensible rod, clamped upright above a plane and pressed against it. Friction holds the
/// tip at the point of first contact. Lengths are in units of the rod's length.
struct PressedElastica {
  double press = 0, side = 0;  ///< force of the plane, upwards and sideways, in units of B / length^2
  std::vector<Vec2> shape;     ///< from clamp to tip: sideways, down

  double friction() const {
    return std::fabs(side / press);
  }  ///< friction coefficient below which the tip slips
};

/// `shortening`: 1 - height / length, above 0, at most 0.33 (Sano, Yamaguchi and Wada 2017, "Slip morphology
/// of elastic strips on frictional rigid substrates"); `edges`: of the shape. Throws Error where no
/// equilibrium is found.
PressedElastica pressedElastica(double shortening, int edges);

}  // namespace strandcast
