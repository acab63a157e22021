#pragma once
#include <string>
#include <vector>

#include "core/strand_block.h"

namespace strandcast::simd {

/// The step of a block of strands, compiled for one instruction set.
struct SimdKernel {
  int lanes = 0;  ///< strands per block, 1 to 16
  /// Advances a block by one step. `scratch`: blockScratch() floats, 64-byte aligned, of any content.
  /// Thread-safe for different blocks with different scratch.
  void (*step_block)(const BlockView<float>& block, const StepInput& input, float* scratch) = nullptr;
};

/// An instruction set that can run here.
struct SimdTarget {
  std::string name;  ///< Highway's name: "AVX3", "AVX2", "SSE4", ...
  SimdKernel kernel;
};

/// The instruction sets that this program was compiled for and the machine can run, best first. Without those
/// that Highway would emulate.
std::vector<SimdTarget> runnableTargets();

}  // namespace strandcast::simd
