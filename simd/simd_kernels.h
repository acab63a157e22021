#pragma once
#include <string>
#include <vector>

#include "core/strand_block.h"

namespace strandcast::simd {

/// The step of a block, compiled for one instruction set.
struct SimdKernel {
  int lanes = 0;  ///< strands per block, 1 to 16
  /// `scratch`: blockScratch() floats, 64-byte aligned.
  void (*step_block)(const BlockView<float>& block, const StepInput& input, float* scratch) = nullptr;
};

struct SimdTarget {
  std::string name;  ///< as Highway calls it: "AVX3", "AVX2", "SSE4", ...
  SimdKernel kernel;
};

/// What this program was compiled for and the machine can run, best first. Never what Highway would only
/// emulate.
std::vector<SimdTarget> runnableTargets();

}  // namespace strandcast::simd
