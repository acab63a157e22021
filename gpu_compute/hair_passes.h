#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "air/hair_layout.h"
#include "core/parameters.h"
#include "gpu_compute/air_layout.h"
#include "gpu_compute/strand_groups.h"

namespace strandcast::gpu {

/// The samples of one workgroup: the same pieces of neighbouring strands that are cut alike. 8 words, read by
/// shaders/sample_tile.glsl.
struct SampleTile {
  uint32_t first_strand;                    ///< index in SampleTiles::roots
  uint32_t strands;                         ///< number of strands
  uint32_t first_piece;                     ///< of each strand
  uint32_t pieces;                          ///< per strand
  uint32_t edges, pieces_of_strand, parts;  ///< of each strand, see StrandPieces
  uint32_t margin;  ///< pieces before first_piece that its vertices also need; see hair_gather.comp
};

constexpr uint32_t kTileSamples = 320;  ///< samples per tile at most, with its margin: one invocation each

/// All samples, in tiles. Arrays of samples have kTileSamples entries per tile, within a tile in Morton order
/// of the rest positions.
struct SampleTiles {
  std::vector<SampleTile> tiles;
  std::vector<uint32_t> roots;   ///< per strand, in the order of tiles: its first vertex
  std::vector<uint32_t> order;   ///< per entry: strand of the tile + 65536 x piece of the tile
  std::vector<uint32_t> places;  ///< per element of StrandSamples::samples: its entry
};

/// Divides the samples of `model` into tiles. `layout`: the hair grid, for the order.
SampleTiles sampleTiles(const StrandModel& model, const StrandSamples& samples, const HairLayout& layout);

/// Passes of the hair grid (air/hair_grid.h) as compute shaders, and the external accelerations that the air
/// system gives to vertices. Passes read their settings from an AirBlock: call describe() and
/// AirBlock::send() before them. Precondition of every call: the context in which it was constructed is
/// current.
class HairPasses {
 public:
  /// Measures the rest density of the groom. `box`: of the groom at rest, m; `cells`: per axis. Throws Error
  /// if there are more samples than a dispatch supports.
  HairPasses(const StrandModel& model, const Box& box, int cells, AirBlock& block, ProgramCache& programs);

  const HairLayout& layout() const { return layout_; }
  /// Writes the settings of the passes. `head`: pose of the hair grid; `seconds`: time step.
  void describe(AirSettings& settings, const Pose& head, const Parameters& parameters, double seconds);
  /// Clears the held crowding and the last largest velocity. For hair that was teleported.
  void reset();
  /// Drag rate per vertex, 1/s; empty: all vertices have AirSettings::drag.
  void setRates(std::span<const float> rates);
  /// Parameters::volume_target, from which the fixed-point scale of crowd() follows. Call it before crowd().
  void setVolumeTarget(float volume_target);

  /// Positions, m, and velocities, m/s, of hair: 4 floats per vertex.
  struct Strands {
    const gl::Buffer &positions, &velocities;
  };
  // Passes. Only gather() ends with finishPass(). `drags`: also the nodes weighted by drag, for onAir().
  void splat(const Strands& strands, bool drags);
  void computeDensity(bool drags);
  void crowd(const Strands& strands);
  /// `crowds`: with pressure; `rubs`: with friction.
  void computeForces(bool crowds, bool rubs);
  /// Source of the air's velocity: uniform wind, ambient wind and sources, wind grid.
  enum class Air { kUniform, kFree, kGrid };
  struct Needs {
    bool forces;  ///< there are forces between hairs
    Air air;
    bool along;  ///< drag along strands is less than across
  };
  /// Writes external accelerations, 3 floats per vertex, m/s^2. `centres`: cell-centre velocities of the
  /// wind, used with Air::kGrid; `turbulence` and `sources` are used with Air::kFree. Unused ones may be any
  /// buffer.
  void gather(const Strands& strands, const Needs& needs, const gl::Buffer& centres,
              const gl::Buffer& turbulence, const gl::Buffer& sources, const gl::Buffer& accelerations);

  /// Allocates the memory of splatSlip().
  void reserveSlip();
  /// Splats the directions of hair, for air that slips along hair. After splat().
  void splatSlip(const Strands& strands);
  /// Hair as the air feels it, with masses weighted by DragShares. `slips`: with the result of splatSlip().
  HairOnAir onAir(bool slips) const {
    return {unevenlyDragged() ? drag_nodes_ : nodes_, slips ? &slip_sums_ : nullptr, &fastest_};
  }
  double meanDrag() const { return drag_shares_.mean; }  ///< mean grooming factor of air_drag, by mass
  std::vector<std::array<float, 4>> downloadNodes() const;

 private:
  void bindTiles(const Strands& strands) const;
  void dispatchTiles() const;
  bool unevenlyDragged() const { return !drag_shares_.of_samples.empty(); }
  void makeDrag(const StrandModel& model, const StrandSamples& samples);
  void dispatchNodes() const;
  void computeRestDensity(const StrandModel& model, AirBlock& block);

  ProgramCache& programs_;
  LazyProgram splat_, slip_of_, fastest_of_, density_of_, crowd_, rest_of_;
  std::array<LazyProgram, 4> forces_of_;   ///< by CROWDS and RUBS
  std::array<LazyProgram, 24> gather_of_;  ///< by AIR, FORCES, RATES and ALONG
  HairLayout layout_;
  DragShares drag_shares_;
  size_t tiles_ = 0, nodes_count_;
  double mass_ = 0;            ///< kg, of all hair
  double crowding_bound_ = 0;  ///< greatest sum of mass x crowding, per stiffness
  float bound_target_ = 0;     ///< volume_target of crowding_bound_
  bool measured_ = false;      ///< the largest velocity before the next splat is known
  bool rated_ = false;         ///< vertices have their own drag rates
  bool clean_ = true;          ///< sums_ is 0
  gl::Buffer sample_tiles_, roots_, order_, edge_masses_, places_, motions_, fastest_, sums_, crowd_sums_,
      slip_sums_, nodes_, densities_, resting_, held_, changes_, rates_;
  // The same with masses weighted by DragShares; empty if all shares are 1. drag_densities_ is never read.
  gl::Buffer drag_edge_masses_, drag_sums_, drag_nodes_, drag_densities_;
};

}  // namespace strandcast::gpu
