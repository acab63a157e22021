// Exact shapes at rest: heavy, pressed and blown elasticas, the catenary, a hung helix.
#pragma once
#include <Eigen/Core>

#include <cmath>
#include <vector>

#include "core/geometry.h"

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

/// Rest position of the tip of a straight elastica, clamped across a uniform wind without gravity, in units
/// of its length L. Drag per length is c (W_across + along_over_across x W_along), the components of the wind
/// W across and along the strand. `load` = c W L^3 / B, above 0, at most about 1e5. Solved by shooting from
/// the tip.
struct WindElasticaTip {
  double downwind = 0;  ///< distance from the clamp along the wind
  double across = 0;    ///< distance from the clamp along the undeformed strand
};
WindElasticaTip windElastica(double load, double along_over_across);

/// Sag of a chain hung between two points of equal height, in units of its length; `span` is their distance
/// in the same unit, between 0 and 1.
double catenarySag(double span);

/// A Kirchhoff rod of round cross section, clamped at its root, under its own weight. Lengths are in units of
/// its length L.
struct HungRod {
  double gamma = 0;               ///< w L^3 / B
  double curvature = 0;           ///< natural curvature x L, about the second material axis
  double torsion = 0;             ///< natural torsion x L
  double twist_ratio = 1 / 1.45;  ///< C / B = 1 / (1 + Poisson's ratio)
  Eigen::Vector3d down = Eigen::Vector3d(
      0, 0, 1);  ///< direction of gravity in the root's material frame, whose z axis is the tangent
};

/// Depth of the tip below the root at rest, in units of L. Solved by shooting from the tip, with continuation
/// from weight 0; NaN where no shape is found.
double hangingDepth(const HungRod& rod);

/// The gamma below which a naturally curved rod of curvature x length `phi`, clamped with its root downwards,
/// leaves its plane (Miller et al. 2014). At that gamma the planar rest shape has an adjacent equilibrium out
/// of the plane. NaN unless `phi` is from 6 to 16: in longer rods the influence of the tip on the root is
/// below rounding.
double bendTwistThreshold(double phi, double twist_ratio);

}  // namespace strandcast
