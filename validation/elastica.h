#pragma once

namespace strandcast {

/// Where the tip of a clamped, horizontal, straight elastica comes to rest, in units of its length.
struct ElasticaTip {
  double drop = 0;   ///< below the clamp
  double reach = 0;  ///< away from it

  double slope() const { return drop / reach; }
};

/// From `place` on, of its length from the clamp, 0 to 1, it is so many times as stiff and as heavy; from
/// there on its weight grows evenly, by so much more at the tip.
struct ElasticaStep {
  double place = 1;
  double stiffness = 1;
  double weight = 1;
  double weight_growth = 0;
};

/// Under its own weight, gamma = w L^3 / B (w: weight per length, B: bending stiffness, both at the clamp),
/// and a load P at its tip, alpha = P L^2 / B; both 0 or more, at most about 1e5, not both 0. Solved by
/// shooting from the tip.
ElasticaTip restingElastica(double gamma, double alpha, const ElasticaStep& step = {});

}  // namespace strandcast
