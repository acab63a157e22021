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

}  // namespace strandcast
