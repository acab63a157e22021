#pragma once
#include "gl/current.h"
#include "gpu_compute/gpu_strands.h"

namespace strandcast::gpu {

/// The gpu backend, to what works in its memory between steps.
class GpuDevice {
 public:
  virtual ~GpuDevice() = default;
  /// Of which everything else is; to be made current first.
  virtual gl::HeadlessContext& context() = 0;
  virtual ProgramCache& programs() = 0;
  /// After Backend::load().
  virtual GpuStrands& strands() = 0;
};

}  // namespace strandcast::gpu
