#pragma once
#include <array>
#include <vector>

#include "core/strand_model.h"
#include "gpu_compute/strand_groups.h"

namespace strandcast::gpu {

/// What the course's scheme needs of a model, and its dispatches: a vertex per invocation.
class GaussSeidelStrands {
 public:
  explicit GaussSeidelStrands(const StrandModel& model);
  /// Gives the commands of a step; the buffers of GpuStrands are bound. The first without and the first with
  /// grooming compile.
  void step(bool groomed, ProgramCache& programs);

 private:
  StrandGroups groups_;  ///< key: invocations per strand
  gl::Buffer order_, rest_edge_;
  /// Of groups_, without and with grooming; empty until first needed.
  std::array<std::vector<const gl::Program*>, 2> programs_;
};

}  // namespace strandcast::gpu
