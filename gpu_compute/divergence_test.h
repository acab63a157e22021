#pragma once
#include "core/strand_model.h"
#include "gl/buffer.h"
#include "gpu_compute/mapped_rings.h"
#include "gpu_compute/strand_groups.h"

namespace strandcast::gpu {

/// Backend::mayHaveDiverged() on the GPU: one word is read back in place of all positions. Precondition of
/// every call: the context in which it was constructed is current.
class DivergenceTest {
 public:
  /// Throws Error if the GPU cannot map memory.
  explicit DivergenceTest(const StrandModel& model);
  /// Records the test of `guides`, 3 floats per vertex, m. `offsets`: Offsets of shaders/step_input.glsl. The
  /// first call compiles and may throw Error.
  void start(const gl::Buffer& guides, const gl::Buffer& offsets, ProgramCache& programs);
  /// Waits for the result of the newest start().
  bool finish();

 private:
  uint32_t strands_;
  gl::Buffer squared_reach_;  ///< per strand, m^2
  gl::Buffer found_;          ///< one word
  Readback result_;
  LazyProgram program_;
};

}  // namespace strandcast::gpu
