#pragma once
#include "gl/current.h"
#include "gpu_compute/gpu_strands.h"

namespace strandcast::gpu {

/// Interface of the gpu backend to systems that work in its GPU memory between steps, such as the air system.
class GpuDevice {
 public:
  virtual ~GpuDevice() = default;
  /// The context that owns all GPU objects of the backend; must be current for calls to them.
  virtual gl::HeadlessContext& context() = 0;
  virtual ProgramCache& programs() = 0;
  /// Precondition: Backend::load() was called.
  virtual GpuStrands& strands() = 0;
};

}  // namespace strandcast::gpu
