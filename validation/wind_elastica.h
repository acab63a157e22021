#pragma once

namespace strandcast {

/// Where the tip of a straight elastica comes to rest that is clamped across a uniform wind, without gravity,
/// in units of its length L. Drag per length is c (across + along_over_across x along) of the wind's velocity
/// W; `load` = c W L^3 / B, above 0 and at most about 1e5. Solved by shooting from the tip.
struct WindElasticaTip {
  double downwind = 0;  ///< from the clamp, along the wind
  double across = 0;    ///< from the clamp, as the strand was
};
WindElasticaTip windElastica(double load, double along_over_across);

}  // namespace strandcast
