#pragma once
#include <Eigen/Core>

namespace strandcast {

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
