#pragma once
#include <string>

namespace strandcast {

/// Where a benchmark runs. GPUs are named by what ran on them.
struct Machine {
  std::string cpu;              ///< as the kernel names it, e.g. "AMD EPYC"; "unknown CPU" where it does not
  int cores = 0;                ///< hardware threads
  std::string instruction_set;  ///< the best of the simd backend, by Highway's name: AVX3 is AVX-512
};
Machine thisMachine();

/// "AMD EPYC, 2 threads, AVX3".
std::string describe(const Machine& machine);
/// Programs that ran or wanted to, mean of the last minute; this one is among them. Above the number of
/// hardware threads, times by the wall are those of a busy machine.
double loadAverage();
/// A folder's name for a processor's: "AMD EPYC 9654 (x)" -> "amd-epyc-9654-x".
std::string folderNameOf(const std::string& name);

}  // namespace strandcast
