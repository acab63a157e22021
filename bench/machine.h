// The machine and the build of a benchmark, and the machine's measured limits.
#pragma once
#include <string>

namespace strandcast {

/// The machine of a benchmark. GPUs are identified by the device of each run.
struct Machine {
  std::string cpu;              ///< by the kernel's name, e.g. "AMD EPYC"; "unknown CPU" where there is none
  int cores = 0;                ///< hardware threads
  std::string instruction_set;  ///< the best one of the simd backend, by Highway's name: AVX3 is AVX-512
};
/// The machine that this program runs on.
Machine thisMachine();

/// "AMD EPYC, 2 threads, AVX3".
std::string describe(const Machine& machine);
/// The 1 minute load average; it includes this program. Above the number of hardware threads the machine is
/// busy, and wall times are inflated.
double loadAverage();
/// A folder name for a CPU: "AMD EPYC 9654 (x)" -> "amd-epyc-9654-x".
std::string folderNameOf(const std::string& name);

/// The commit that this program was built from, with a + where sources had uncommitted changes; "unknown"
/// outside a git checkout.
std::string buildCommit();

/// Measured bytes per second that `threads` threads move by copying memory larger than the caches; a byte
/// read and written counts as two.
double measuredCopy(int threads);

/// Measured upper limits of a GPU, by two shaders of this benchmark.
struct GpuLimits {
  double operations_per_s = 0;  ///< independent fused multiply-adds; each counts as two
  double copied_bytes_per_s =
      0;  ///< by copying a buffer larger than the caches; a byte read and written counts as two
};
/// Measures the GPU that the gpu backend selects, in its own context. Throws Error where there is none.
GpuLimits measuredGpuLimits();

/// Measured floating-point operations per second of `threads` threads with independent fused multiply-adds on
/// the widest vectors of this machine; each counts as two.
double measuredPeak(int threads);
/// The same for one thread, per second of processor time, which excludes other load on the machine.
double measuredPeakOfProcessor();

}  // namespace strandcast
