#pragma once

namespace strandcast {

/// Rest position of the tip of a clamped, horizontal, straight elastica, in units of its length.
struct ElasticaTip {
  double drop = 0;   ///< depth below the clamp
  double reach = 0;  ///< horizontal distance from the clamp

  double slope() const { return drop / reach; }
};

/// A change of properties at `place`, a fraction of the length from the clamp, 0 to 1. Beyond it stiffness
/// and weight are multiplied by these factors, and the weight grows linearly by weight_growth up to the tip.
struct ElasticaStep {
  double place = 1;
  double stiffness = 1;
  double weight = 1;
  double weight_growth = 0;
};

/// Rest position under its own weight, gamma = w L^3 / B (w: weight per length, B: bending stiffness, both at
/// the clamp), and a load P at the tip, alpha = P L^2 / B. Both are from 0 to about 1e5, not both 0. Solved
/// by shooting from the tip.
ElasticaTip restingElastica(double gamma, double alpha, const ElasticaStep& step = {});

}  // namespace strandcast
