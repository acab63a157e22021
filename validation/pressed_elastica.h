#pragma once
#include <cmath>
#include <vector>

#include "core/geometry.h"

namespace strandcast {

/// A weightless inextensible rod, clamped upright above a plane that its tip is pressed against and held by
/// where it first touched. In units of the length.
struct PressedElastica {
  double press = 0, side = 0;  ///< force of the plane, upwards and sideways, in units of B / length^2
  std::vector<Vec2> shape;     ///< from clamp to tip: sideways, down

  double friction() const { return std::fabs(side / press); }  ///< with less the tip slips
};

/// `shortening`: 1 - height / length, above 0, at most 0.33 (Sano, Yamaguchi and Wada 2017, "Slip morphology
/// of elastic strips on frictional rigid substrates"); `edges` of the shape. Error where no balance is found.
PressedElastica pressedElastica(double shortening, int edges);

}  // namespace strandcast
