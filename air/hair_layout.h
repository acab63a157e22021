#pragma once
#include <optional>

#include "core/geometry.h"

namespace strandcast {

/// Where the nodes of the hair grid are, in the frame of the groom, and what is the same on every backend.
struct HairLayout {
  int cells;    ///< nodes per axis
  float cell;   ///< m
  Vec3 corner;  ///< m, of node (0, 0, 0)

  /// From the world to places in cells, `head` carrying the grid: 3 rows of 3, then the offset.
  template <class Scalar>
  void frame(const Pose& head, Scalar* out) const {
    const Eigen::Matrix3f turn = Eigen::Quaternionf(head.rotation).toRotationMatrix().transpose();
    const Eigen::Vector3f offset =
        (-(turn * Eigen::Vector3f(head.position)) - Eigen::Vector3f(corner)) / cell;
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) out[3 * r + c] = static_cast<Scalar>(turn(r, c) / cell);
      out[9 + r] = static_cast<Scalar>(offset[r]);
    }
  }
  /// The largest stiffness that is heeded with steps of `seconds`, m^2/s^2: waves of pressure must not go
  /// much farther than a cell in a step.
  double largestStiffness(double seconds) const;
};

/// Where the head will be partAhead() of a step from `now`, if it goes on as it came from `before`, where it
/// was a step ago; it stands still where that is not known.
Pose headAhead(const std::optional<Pose>& before, const Pose& now);

/// `box`: of the groom at rest, m.
HairLayout hairLayout(const Box& box, int cells);

constexpr double kWhole = 1 << 30;  ///< what all hair in one node would come to in whole numbers
/// Densities are known to about this part of themselves: floats that places are made of, whole numbers that
/// shares are. Hair is denser than at rest only where it is by more.
constexpr double kDensityNoise = 1e-4;
/// A sample alone makes a density of at least this x its mass / cell^3 where it is: 0.375^3.
constexpr double kDensityAlone = 0.05;
constexpr double kMostHeld = 3;  ///< of what crowding comes to at most, that is held

}  // namespace strandcast
