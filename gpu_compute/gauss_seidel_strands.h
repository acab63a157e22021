#pragma once
#include <vector>

#include "core/strand_model.h"
#include "gpu_compute/strand_groups.h"

namespace strandcast::gpu {

/// What the course's scheme needs of a model, and its dispatches: a vertex per invocation.
class GaussSeidelStrands {
 public:
  explicit GaussSeidelStrands(const StrandModel& model);
  /// Gives the commands of a step; the buffers of GpuStrands are bound. The first compiles.
  void step(ProgramCache& programs);

 private:
  StrandGroups groups_;  ///< key: invocations per strand
  gl::Buffer rest_edge_;
  std::vector<const gl::Program*> programs_;  ///< of groups_; empty until the first step
};

}  // namespace strandcast::gpu
