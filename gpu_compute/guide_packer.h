#pragma once
#include <optional>
#include <span>
#include <vector>

#include "core/guide_packing.h"
#include "core/strand_model.h"
#include "gl/buffer.h"
#include "gl/timers.h"
#include "gpu_compute/mapped_rings.h"
#include "gpu_compute/strand_groups.h"

namespace strandcast::gpu {

/// Packs guides on the GPU, so that some 3.5 bytes per vertex cross to the CPU in place of 12
/// (shaders/pack_guides.comp). They are packed in the GPU's memory without gaps, and as many bytes as the
/// frame before had are copied at once; what a frame has beyond them is copied when its size is known.
/// Precondition of every call: the context in which it was constructed is current. Memory per vertex: 24
/// bytes on the GPU, 7 on the CPU.
class GuidePacker {
 public:
  /// Precondition: `grid` has the strands of `model`, of at most 2^30 vertices. Compiles. Throws Error if the
  /// GPU lacks memory, or the shader does not build. `programs` must outlive this.
  GuidePacker(const StrandModel& model, const GuideGrid& grid, ProgramCache& programs);

  uint64_t gridNumber() const { return grid_number_; }
  /// The frame of the newest start().
  const PackingFrame& frame() const { return frame_; }
  /// Records the packing and the copy of `guides`, 3 floats per vertex, m. `offsets`: Offsets of
  /// shaders/step_input.glsl.
  void start(const gl::Buffer& guides, const gl::Buffer& offsets, const PackingFrame& frame);
  /// Waits for the newest start(). One entry per run of the grid, valid until the next start().
  std::span<const PackedRun> finish();
  /// GPU time of the packing of a recent start(), without the copy, s; see gl::StepTimer::newest().
  std::optional<double> seconds() const { return timer_.newest(); }

 private:
  /// No run has taken a place in packed_.
  void clearTaken();

  uint64_t grid_number_;
  const gl::Program* program_;
  float step_, per_step_, squared_limit_;
  PackingFrame frame_;
  std::vector<PackedRun> runs_;
  uint32_t first_data_word_;  ///< of packed_
  gl::Buffer run_table_;      ///< Runs of the shader
  gl::Buffer edge_vertices_;  ///< Edges
  gl::Buffer rest_roots_;     ///< RestRoots
  gl::Buffer symbols_;        ///< Symbols
  gl::Buffer packed_;         ///< Packed
  Readback readback_;         ///< of packed_
  size_t copied_ = 0;         ///< bytes of packed_ that are in readback_, or will be
  size_t next_copy_;          ///< bytes that the next start() copies
  gl::StepTimer timer_;
};

}  // namespace strandcast::gpu
