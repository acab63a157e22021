#pragma once
#include <span>

#include "air/drag_shares.h"
#include "air/grid_passes.h"
#include "air/hair_layout.h"
#include "air/strand_samples.h"
#include "air/workers.h"
#include "core/backend.h"

namespace strandcast {

/// Forces between hairs, on a grid that is carried rigidly by the head, so that hair at rest falls on the
/// same places wherever the head is (Petrovic, Henne, Anderson 2005, "Volumetric Methods for Simulation and
/// Rendering of Hair"). Density and momentum of strands are splatted in whole numbers: any number of threads
/// gives the same bits. Forces come in opposite pairs, so that the momentum of all hair is kept:
///
/// with B the blur, d = B m the density, f = stiffness max(0, d - rest / volume_target) / d^2 and what is
/// held beyond it (heldCrowding), and G the central difference, hair is accelerated by -(f G d + G B (m f))
/// as smoothed particles are (Monaghan 1992); with D = d^(-1/2), friction draws it at hair_friction to D B D
/// p, in the measure of D B D m: without the square root on both sides the sum of all impulses would not be
/// 0.
template <class Scalar>
class HairGrid {
 public:
  /// Measures the rest density from the groom at rest. `box`: of the groom at rest, in its frame.
  HairGrid(const GridPasses<Scalar>& passes, const Workers& workers, const StrandModel& model, int cells,
           const Box& box);

  float cell() const { return layout_.cell; }  ///< m
  const StrandSamples& samples() const { return samples_; }

  /// Where hair will be after so many `seconds` and how fast it is: samples, on the grid as `head` carries it
  /// then. Natural order.
  void locate(std::span<const Vec3> positions, std::span<const Vec3> velocities, const Pose& head,
              double seconds = 0);
  /// Their sums on the grid.
  void splat();
  /// After that, the same weighed by how much of the drag is whose: for dragNodes().
  void splatDrag();
  /// Room for splatSlip(), which allocates nothing.
  void expectSlip();
  /// After splat(): which way hair lies, by its part of the drag, for slipNodes(). `positions` of locate().
  void splatSlip(std::span<const Vec3> positions);
  /// Nothing is held any more: hair was put elsewhere.
  void reset();
  /// densityAtPoint() is asked about places from `way` (m) farther on from now on.
  void moveOrigin(const Vec3& way);
  /// From what was splatted: how samples change their velocities over a step of `seconds`.
  void findForces(const Parameters& parameters, double seconds);
  /// Change of velocity of samples begin .. end - 1, m/s, 4 numbers each.
  void changes(size_t begin, size_t end, Scalar* out) const;

  /// PlacePlane `plane` of all samples; 16 numbers to spare.
  const Scalar* places(int plane) const { return places_.data() + static_cast<size_t>(plane) * view_.stride; }
  /// Velocity of sample n, 3 numbers.
  const Scalar* velocity(size_t n) const { return motion_.data() + 4 * n; }
  const GridShape& shape() const { return shape_; }
  /// Momentum per volume and density (kg/m^3, of the strands themselves), from place (0, 0, 0).
  const Scalar* nodes() const { return nodes_.data() + 4 * origin_; }
  /// As the air feels it: masses x their shares of the drag.
  const Scalar* dragNodes() const {
    return (drag_shares_.of_samples.empty() ? nodes_ : drag_nodes_).data() + 4 * origin_;
  }
  /// Of the same masses m that go into dragNodes(), directions t (directionOfPiece in kernels/grid.h) and
  /// velocities v, per volume: part 0 is m t (t.v) and m t t' xx, part 1 m t t' yy, yz, xz, xy.
  const Scalar* slipNodes(size_t part) const { return slip_nodes_[part].data() + 4 * origin_; }
  double meanDrag() const { return drag_shares_.mean; }  ///< factor of air_drag, of all hair
  const NodeBox& box() const { return filled_; }         ///< beyond it nodes are empty
  const Scalar* frame() const { return frame_; }
  /// Density at a node, blurred, kg/m^3.
  double densityAt(int i, int j, int k) const { return static_cast<double>(density_[shape_.at(i, j, k)]); }
  /// Density at the node nearest to a point of the world, kg/m^3, as it was splatted; 0 beyond the grid.
  float densityAtPoint(const Vec3& point) const;
  /// Rest density that sample n carries, kg/m^3.
  float restDensity(size_t n) const { return static_cast<float>(rest_density_[n]); }
  /// Of the sums of the last splat: equal bits, equal hashes.
  uint64_t splatHash() const;

 private:
  template <class Work>
  void eachLayer(const NodeBox& box, const Work& work) const;
  void blur(int numbers, const NodeBox& box, GridArray<Scalar>& field);
  void blurDensity(const NodeBox& box);
  /// Where blurs have something to do: around all nodes that hair is on, and those that it was on when they
  /// did it last.
  NodeBox blurBox(bool crowds, bool rubs);
  void measureRest(const StrandModel& model);
  /// To nodes of 4 numbers, where `box` says that there may be some, or were.
  void sumUp(const SplatView<Scalar>& view, const NodeBox& box, GridArray<Scalar>& nodes);
  /// What crowding and what is held of it can come to at most.
  void boundCrowding(float volume_target);
  void findCrowding(const Parameters& parameters, double stiffness, double seconds, const NodeBox& box);
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
  double mass_ = 0;  ///< kg, of all samples
  size_t chunks_;    ///< of samples, each with sums of its own
  std::vector<std::vector<int32_t, CacheLineAllocator<int32_t>>> sums_, number_sums_;
  SplatView<Scalar> view_{};               ///< of the last splat
  std::vector<SplatReach<Scalar>> reach_;  ///< per chunk
  NodeBox filled_;                         ///< beyond it sums_ and nodes_ are 0
  NodeBox drag_filled_;                    ///< and drag_nodes_ beyond this
  NodeBox slip_filled_;                    ///< and slip_nodes_ beyond this
  NodeBox blurred_;  ///< filled_ of the last blur: a node around it all that comes from blurs is 0
  bool crowded_before_ = false, rubbed_before_ = false;  ///< in it
  float bound_target_ = 0;                               ///< volume_target of crowding_bound_
  double crowding_bound_ = 0;  ///< of all samples, mass x crowding with a stiffness of 1
  GridArray<Scalar> places_, motion_, masses_, drag_masses_, drag_nodes_, slip_of_samples_[2], slip_nodes_[2],
      rest_density_, held_, largest_crowding_, nodes_, density_, spread_, crowding_, crowded_, scratch_,
      scratch4_, changes_;
};

extern template class HairGrid<float>;
extern template class HairGrid<double>;

}  // namespace strandcast
