// How hair lies on the hair grid: placement of nodes, samples of strands, their shares of the drag.
#pragma once
#include <array>
#include <vector>

#include "air/grid_passes.h"
#include "core/geometry.h"
#include "core/strand_model.h"

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
  void moveOrigin() { is_rebased_ = true; }

 private:
  bool known_ = false, is_rebased_ = false;
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
constexpr double kMaxHeldCrowding = 3;  ///< bound of the held crowding, in units of the largest crowding

/// How a strand is cut into pieces: several whole edges per piece, distributed evenly, or each edge into
/// equal parts.
struct StrandPieces {
  uint32_t vertex;  ///< first vertex of the strand
  uint32_t edges;
  uint32_t sample;  ///< first sample of the strand
  uint16_t pieces;  ///< of the strand; edges x parts where parts > 1
  uint16_t parts;   ///< parts per edge; 1: pieces consist of whole edges

  /// First edge of piece p, relative to the strand's first edge. A piece of whole edges ends where piece p +
  /// 1 begins.
  uint32_t firstEdge(uint32_t p) const { return parts > 1 ? p / parts : p * edges / pieces; }
};

/// Samples that represent strands on a grid, one per piece: whole edges with a total length of up to 1.5
/// cells, or parts of a longer edge. The samples of a strand are contiguous, root to tip.
struct StrandSamples {
  std::vector<StrandSample> samples;
  std::vector<float> shares;          ///< weights of a sample's vertices, sum 1 per sample
  std::vector<StrandPieces> strands;  ///< per strand
  std::vector<uint32_t> offsets;      ///< strands + 1: first sample of each strand
  /// kg, per vertex: masses at the start and at the end of the edge that starts there; 0 at tips.
  std::vector<std::array<float, 2>> edge_masses;
  /// Per entry of `shares`: the sample's mass at that vertex over the mass of the vertex. The sum over all
  /// samples of a vertex is 1.
  std::vector<float> vertex_parts;
};

/// `cell` in metres.
StrandSamples strandSamples(const StrandModel& model, float cell);

/// Distribution of the drag over the samples where strands have drag factors (StrandModel::air_drag_scale).
/// The momentum that the air loses then equals the momentum that the hair gains.
struct DragShares {
  double mean = 1;  ///< mean drag factor of all hair, weighted by mass
  /// Per sample: its drag factor over the mean. The sum of mass x share equals the sum of masses. Empty: all
  /// shares are 1.
  std::vector<float> of_samples;
};

DragShares dragShares(const StrandModel& model, const StrandSamples& samples);

}  // namespace strandcast
