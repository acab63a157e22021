#pragma once
#include <array>
#include <vector>

#include "air/drag_shares.h"
#include "air/hair_layout.h"
#include "air/strand_samples.h"
#include "core/parameters.h"
#include "gpu_compute/air_layout.h"
#include "gpu_compute/strand_groups.h"

namespace strandcast::gpu {

/// The forces between hairs of air/hair_grid.h as compute shaders, and what all of air/ gives to vertices.
/// What a pass is told goes through `block`, which is sent before it. Every call needs the context that made
/// it current.
class HairPasses {
 public:
  /// Measures the rest density from the groom at rest. Throws Error where there are more samples than a
  /// dispatch takes.
  HairPasses(const StrandModel& model, const Box& box, int cells, AirBlock& block, ProgramCache& programs);

  const HairLayout& layout() const { return layout_; }
  /// Writes what the passes need to know into the settings.
  void describe(AirSettings& settings, const Pose& head, const Parameters& parameters, double seconds);
  /// Nothing is held any more, and what is known of velocities is nothing: hair was put elsewhere.
  void reset();
  /// Drags of their own, 1/s per vertex; empty: all have that of the settings.
  void takeRates(std::span<const float> rates);
  /// Parameters::volume_target, which bounds what crowd() can sum. To be called before the first crowd().
  void takeVolumeTarget(float volume_target);

  /// Where hair is and how fast, 4 numbers per vertex.
  struct Strands {
    const gl::Buffer &positions, &velocities;
  };
  // Passes. Only gather() ends with finishPass(). `drags`: for dragNodes(), too.
  void splat(const Strands& strands, bool drags);
  void findDensity(bool drags);
  void crowd(const Strands& strands);
  void findForces(bool crowds, bool rubs);
  enum class Air { kUniform, kFree, kGrid };
  struct Needs {
    bool forces;
    Air air;
    bool along;  ///< drag along strands is less than across
  };
  /// An acceleration per vertex, 3 numbers each. `centres`: of the wind, where there is a grid; else any
  /// buffer, as `turbulence` and `sources` where the air is not free.
  void gather(const Strands& strands, const Needs& needs, const gl::Buffer& centres,
              const gl::Buffer& turbulence, const gl::Buffer& sources, const gl::Buffer& accelerations);

  /// Room for splatSlip().
  void expectSlip();
  /// Which way hair lies, as the air feels it: after splat().
  void splatSlip(const Strands& strands);
  /// With masses x their DragShares. `slips`: after splatSlip().
  HairOnAir onAir(bool slips) const {
    return {unevenlyDragged() ? drag_nodes_ : nodes_, slips ? &slip_sums_ : nullptr, &fastest_};
  }
  double meanDrag() const { return drag_shares_.mean; }  ///< factor of air_drag, of all hair
  std::vector<std::array<float, 4>> downloadNodes() const;

 private:
  void bindTiles(const Strands& strands) const;
  void dispatchTiles() const;
  bool unevenlyDragged() const { return !drag_shares_.of_samples.empty(); }
  void makeDrag(const StrandModel& model, const StrandSamples& samples);
  void dispatchNodes() const;
  void measureRest(const StrandModel& model, AirBlock& block);

  ProgramCache& programs_;
  LazyProgram splat_, slip_of_, fastest_of_, density_of_, crowd_, rest_of_;
  std::array<LazyProgram, 4> forces_of_;   ///< by crowding and friction
  std::array<LazyProgram, 24> gather_of_;  ///< by what there is to gather
  HairLayout layout_;
  DragShares drag_shares_;
  size_t tiles_ = 0, nodes_count_;
  double mass_ = 0;
  double crowding_bound_ = 0;
  float bound_target_ = 0;  ///< what it is for
  bool measured_ = false;   ///< the fastest velocity before the next splat is known
  bool rated_ = false;
  bool clean_ = true;  ///< sums are 0
  gl::Buffer sample_tiles_, roots_, order_, edge_masses_, places_, motions_, fastest_, sums_, crowd_sums_,
      slip_sums_, nodes_, densities_, resting_, held_, changes_, rates_;
  // Where pieces have shares of the drag of their own: the same as the air feels it. Its densities are of no
  // use.
  gl::Buffer drag_edge_masses_, drag_sums_, drag_nodes_, drag_densities_;
};

}  // namespace strandcast::gpu
