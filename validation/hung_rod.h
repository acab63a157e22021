#pragma once
#include <Eigen/Core>

namespace strandcast {

/// A Kirchhoff rod of round section, clamped at its root, under its own weight. Lengths in units of its
/// length L.
struct HungRod {
  double gamma = 0;               ///< w L^3 / B
  double curvature = 0;           ///< natural, x L, about the material's second axis
  double torsion = 0;             ///< natural, x L
  double twist_ratio = 1 / 1.45;  ///< C / B = 1 / (1 + Poisson's ratio)
  Eigen::Vector3d down =
      Eigen::Vector3d(0, 0, 1);  ///< of gravity, in the root's material frame; z is its tangent
};

/// How far the tip hangs below the root at rest, in units of L. Shooting from the tip, followed from no
/// weight on; not a number where that leads to no shape.
double hangingDepth(const HungRod& rod);

/// The gamma below which a naturally curved rod of curvature x length `phi`, clamped with its root downwards,
/// leaves its plane (Miller et al. 2014): there the planar rest shape has a neighbour out of the plane. `phi`
/// from 6 to 16, else not a number: in longer rods rounding drowns what the root feels of the tip.
double bendTwistThreshold(double phi, double twist_ratio);

}  // namespace strandcast
