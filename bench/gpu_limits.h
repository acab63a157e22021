#pragma once

namespace strandcast {

/// What a GPU does at most, measured with two shaders of the benchmark's own.
struct GpuLimits {
  double operations_per_s = 0;  ///< with independent fused multiply-adds; one counts two
  double copied_bytes_per_s =
      0;  ///< by copying a buffer beyond its caches; a byte read and written counts two
};
/// Of the GPU that the gpu backend takes, in a context of its own. Throws Error when there is none.
GpuLimits measuredGpuLimits();

}  // namespace strandcast
