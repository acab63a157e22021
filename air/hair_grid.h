#pragma once
#include <span>

#include "air/grid_passes.h"
#include "air/hair_layout.h"
#include "core/backend.h"

namespace strandcast {

/// Forces between hairs on a grid that the head carries rigidly, so hair at rest has the same grid
/// coordinates at every head pose (Petrovic, Henne, Anderson 2005, "Volumetric Methods for Simulation and
/// Rendering of Hair"). Density and momentum of strands are splatted in fixed point: any number of threads
/// gives the same bits. Forces are pairwise opposite, so the momentum of all hair is conserved.
///
/// Notation: m mass and p momentum of a node, B the blur, d = B m the density, G the central difference.
/// Pressure: with f = stiffness max(0, d - rest / volume_target) / d^2, plus the held part (heldCrowding),
/// the acceleration is -(f G d + G B (m f)), as of smoothed particles (Monaghan 1992). Friction: with D =
/// d^(-1/2), hair approaches D B D p / (D B D m) at the rate hair_friction. The square root on both sides of
/// B makes the sum of all impulses 0.
template <class Scalar>
class HairGrid {
 public:
  /// Measures the rest density from the groom at rest. `box`: bounds of the groom at rest, m, in its frame.
  /// `passes` and `workers` must outlive this.
  HairGrid(const GridPasses<Scalar>& passes, const Workers& workers, const StrandModel& model, int cells,
           const Box& box);

  float cell() const { return layout_.cell; }  ///< m
  const StrandSamples& samples() const { return samples_; }

  /// Computes positions and velocities of samples, positions extrapolated by `seconds`. `head`: the pose that
  /// carries the grid at that time. Vertices in natural order, m and m/s.
  void locate(std::span<const Vec3> positions, std::span<const Vec3> velocities, const Pose& head,
              double seconds = 0);
  /// Splats mass and momentum of the samples of locate().
  void splat();
  /// After splat(): splats again with masses weighted by drag shares, for dragNodes().
  void splatDrag();
  /// Allocates memory for splatSlip(), which does not allocate.
  void reserveSlip();
  /// After splat(): splats directions of hair weighted by drag shares, for slipNodes(). `positions`: those of
  /// locate().
  void splatSlip(std::span<const Vec3> positions);
  /// Clears the held crowding, after a teleport of the hair.
  void reset();
  /// Origin rebasing: points of densityAtPoint() are from an origin moved by `way` (m).
  void moveOrigin(const Vec3& way);
  /// From the splat: computes the velocity changes of nodes over a step of `seconds`.
  void computeForces(const Parameters& parameters, double seconds);
  /// Interpolates the velocity changes of samples begin .. end - 1, m/s, 4 numbers each. Precondition:
  /// computeForces().
  void changes(size_t begin, size_t end, Scalar* out) const;

  /// PlacePlane `plane` of all samples; 16 spare numbers.
  const Scalar* places(int plane) const { return places_.data() + static_cast<size_t>(plane) * view_.stride; }
  /// Velocity of sample n, m/s, 3 numbers.
  const Scalar* velocity(size_t n) const { return motion_.data() + 4 * n; }
  const GridShape& shape() const { return shape_; }
  /// Momentum per volume (kg/(m^2 s)) and density (kg/m^3) of the strands, 4 per node, from index (0, 0, 0).
  const Scalar* nodes() const { return nodes_.data() + 4 * origin_; }
  /// The same with masses weighted by their drag shares: the hair as the air sees it.
  const Scalar* dragNodes() const {
    return (drag_shares_.of_samples.empty() ? nodes_ : drag_nodes_).data() + 4 * origin_;
  }
  /// Sums per volume over samples of mass m (as in dragNodes()), direction t (directionOfPiece() in
  /// kernels/grid.h) and velocity v. Part 0: m t (t.v), m t t' xx. Part 1: m t t' yy, yz, xz, xy.
  const Scalar* slipNodes(size_t part) const { return slip_nodes_[part].data() + 4 * origin_; }
  double meanDrag() const { return drag_shares_.mean; }  ///< mean factor of air_drag, of all hair
  const NodeBox& box() const { return filled_; }         ///< nodes outside are empty
  /// Positions (m) to cells, as SplatView::frame.
  const Scalar* frame() const { return frame_; }
  /// Blurred density of a node, kg/m^3.
  double densityAt(int i, int j, int k) const { return static_cast<double>(density_[shape_.at(i, j, k)]); }
  /// Splatted density of the node nearest to a point (m from the origin), kg/m^3; 0 outside the grid.
  float densityAtPoint(const Vec3& point) const;
  /// Rest density of sample n, kg/m^3.
  float restDensity(size_t n) const { return static_cast<float>(rest_density_[n]); }
  /// Hash of the fixed-point sums of the last splat.
  uint64_t splatHash() const;

 private:
  template <class Work>
  void eachLayer(const NodeBox& box, const Work& work) const;
  void blur(int numbers, const NodeBox& box, GridArray<Scalar>& field);
  void blurDensity(const NodeBox& box);
  /// Region of a blur: one node around all nodes with hair, now and at the last blur.
  NodeBox blurBox(bool crowds, bool rubs);
  void computeRestDensity(const StrandModel& model);
  /// Splats into nodes of 4 numbers. `box`: nodes that are not empty now, or were not before.
  void splatNodes(const SplatView<Scalar>& view, const NodeBox& box, GridArray<Scalar>& nodes);
  /// Computes bounds of crowding and held crowding, which fix the fixed-point scale.
  void computeCrowdingBounds(float volume_target);
  void computeCrowding(const Parameters& parameters, double stiffness, double seconds, const NodeBox& box);
  size_t firstOf(size_t chunk) const {
    return chunk == chunks_ ? samples_.samples.size() : samples_.samples.size() * chunk / chunks_ / 16 * 16;
  }

  const GridPasses<Scalar>& passes_;
  const Workers& workers_;
  GridShape shape_;
  size_t origin_;
  HairLayout layout_;
  Scalar frame_[12] = {};
  Pose head_;
  StrandSamples samples_;
  DragShares drag_shares_;
  double mass_ = 0;  ///< kg, sum of all samples
  size_t chunks_;    ///< number of chunks of samples; each has its own sums
  std::vector<std::vector<int32_t, CacheLineAllocator<int32_t>>> sums_, number_sums_;
  SplatView<Scalar> view_{};               ///< of the last locate() and splat()
  std::vector<SplatReach<Scalar>> reach_;  ///< per chunk
  NodeBox filled_;                         ///< outside it sums_ and nodes_ are 0
  NodeBox drag_filled_;                    ///< outside it drag_nodes_ are 0
  NodeBox slip_filled_;                    ///< outside it slip_nodes_ are 0
  NodeBox blurred_;  ///< filled_ at the last blur; outside it, grown by one node, blurred fields are 0
  bool had_crowding_ = false, had_friction_ = false;  ///< settings of the last blur
  float bound_target_ = 0;                            ///< volume_target that crowding_bound_ is for
  double crowding_bound_ = 0;  ///< sum over samples of mass x largest crowding, at a stiffness of 1
  GridArray<Scalar> places_, motion_, masses_, drag_masses_, drag_nodes_, slip_of_samples_[2], slip_nodes_[2],
      rest_density_, held_, largest_crowding_, nodes_, density_, spread_, crowding_, crowded_, scratch_,
      scratch4_, changes_;
};

extern template class HairGrid<float>;
extern template class HairGrid<double>;

}  // namespace strandcast
