#pragma once
#include "core/geometry.h"

namespace strandcast {

/// Placement of the hair grid's nodes in the frame of the groom, and constants shared by all backends.
struct HairLayout {
  int cells;    ///< nodes per axis
  float cell;   ///< m
  Vec3 corner;  ///< m, of node (0, 0, 0)

  /// Writes the affine map from positions (m) to grid coordinates (cells) while `head` carries the grid:
  /// 12 numbers, 3 rows of 3, then the offset.
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
  /// Upper bound of the stiffness for steps of `seconds`, m^2/s^2: pressure waves must not travel much
  /// farther than a cell in a step.
  double largestStiffness(double seconds) const;
};

/// Extrapolates the pose of the head, which carries the hair grid, from step to step.
class HeadExtrapolation {
 public:
  /// Pose after the part extrapolationShare() of the step from `begin` to `end`, extrapolated with the motion
  /// of the last step. Returns `begin` where the last call did not end there, as after steps without air.
  Pose ahead(const Pose& begin, const Pose& end);
  /// The head was teleported: the last motion is discarded.
  void forget() { known_ = false; }
  /// Origin rebasing: the next `begin` is where the last step ended, in other coordinates.
  void moveOrigin() { retold_ = true; }

 private:
  bool known_ = false, retold_ = false;
  Pose begin_, end_;  ///< of the last step
};

/// `box`: bounds of the groom at rest, m.
HairLayout hairLayout(const Box& box, int cells);

constexpr double kWhole = 1 << 30;  ///< fixed-point value of a node that holds all hair
/// Relative error of densities, from floats in positions and fixed-point shares. Hair counts as denser than
/// at rest only beyond this.
constexpr double kDensityNoise = 1e-4;
/// A single sample makes at its own position a density of at least this x mass / cell^3: 0.375^3.
constexpr double kDensityAlone = 0.05;
constexpr double kMostHeld = 3;  ///< bound of the held crowding, in units of the largest crowding

}  // namespace strandcast
