#pragma once
#include <array>
#include <vector>

#include "core/strand_model.h"
#include "gpu_compute/strand_groups.h"

namespace strandcast::gpu {

/// The PBD solver (after Yuksel and Tariq 2010) on the GPU: its copy of a model's rest data and its
/// dispatches, with one vertex per invocation (shaders/gauss_seidel.comp). Needs a current context for its
/// whole life.
class GaussSeidelStrands {
 public:
  /// `compiles_slowly`: strands of a vertex count that fewer than kMinVariantStrands strands have share a
  /// wider variant, so that fewer variants are compiled.
  GaussSeidelStrands(const StrandModel& model, bool compiles_slowly);
  /// Records the dispatches of a step. Precondition: the buffers of GpuStrands are bound. The first step with
  /// new arguments compiles and may throw Error. `groomed`: GROOMED of shaders/gauss_seidel.comp, 0 or one
  /// other value for all steps of a model. `accelerated`: vertices have external accelerations. `bends`: some
  /// fields bend.
  void step(int groomed, bool accelerated, bool bends, ProgramCache& programs);

 private:
  StrandGroups groups_;  ///< key: invocations per strand
  gl::Buffer order_, rest_edge_;
  /// Per group, indexed by grooming, acceleration and bending fields; empty until first needed.
  std::array<std::vector<const gl::Program*>, 8> programs_;
};

}  // namespace strandcast::gpu
