#pragma once

namespace strandcast {

/// Rest position of the tip of a straight elastica, clamped across a uniform wind without gravity, in units
/// of its length L. Drag per length is c (W_across + along_over_across x W_along), the components of the wind
/// W across and along the strand. `load` = c W L^3 / B, above 0, at most about 1e5. Solved by shooting from
/// the tip.
struct WindElasticaTip {
  double downwind = 0;  ///< distance from the clamp along the wind
  double across = 0;    ///< distance from the clamp along the undeformed strand
};
WindElasticaTip windElastica(double load, double along_over_across);

}  // namespace strandcast
