#pragma once
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

/// How the head, which carries the grid, goes from step to step.
class HeadCourse {
 public:
  /// Where it will be partAhead() of the step that is about to be done from `begin` to `end`, if it goes on
  /// as in the last one; where it is now, if that did not take it there, as after steps without air.
  Pose ahead(const Pose& begin, const Pose& end);
  /// It has been put elsewhere.
  void forget() { known_ = false; }
  /// Places are told from elsewhere from now on; it is where the last step took it.
  void moveOrigin() { retold_ = true; }

 private:
  bool known_ = false, retold_ = false;
  Pose begin_, end_;  ///< of the last step
};

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
