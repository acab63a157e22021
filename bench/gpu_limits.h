#pragma once

namespace strandcast {

/// Measured upper limits of a GPU, by two shaders of this benchmark.
struct GpuLimits {
  double operations_per_s = 0;  ///< independent fused multiply-adds; each counts as two
  double copied_bytes_per_s =
      0;  ///< by copying a buffer larger than the caches; a byte read and written counts as two
};
/// Measures the GPU that the gpu backend selects, in its own context. Throws Error where there is none.
GpuLimits measuredGpuLimits();

}  // namespace strandcast
