#pragma once
#include <array>
#include <vector>

#include "core/strand_model.h"
#include "gpu_compute/strand_groups.h"

namespace strandcast::gpu {

/// What the course's scheme needs of a model, and its dispatches: a vertex per invocation.
class GaussSeidelStrands {
 public:
  /// `compiles_slowly`: few strands of a width go along with wider ones.
  GaussSeidelStrands(const StrandModel& model, bool compiles_slowly);
  /// Gives the commands of a step; the buffers of GpuStrands are bound. The first of each kind compiles.
  /// `groomed`: GROOMED of shaders/gauss_seidel.comp, 0 or one other value for all steps of a model.
  void step(int groomed, bool accelerated, bool bends, ProgramCache& programs);

 private:
  StrandGroups groups_;  ///< key: invocations per strand
  gl::Buffer order_, rest_edge_;
  /// Of groups_, by grooming, acceleration and fields that bend; empty until first needed.
  std::array<std::vector<const gl::Program*>, 8> programs_;
};

}  // namespace strandcast::gpu
