#pragma once
#include <array>

#include "core/backend.h"
#include "core/strand_block.h"

namespace strandcast {

/// Floating-point operations of a step, per vertex and substep.
struct OperationCount {
  double all = 0;
  std::array<double, kStepParts> parts{};  ///< indexed by StepPart; sums to `all`
};
/// Counts the operations by running the source of the CPU step with a counting number type, on about a
/// thousand strands, evenly chosen.
OperationCount countOperations(const StrandModel& model, const StrandState& state, const StepInput& input);

/// A part's name in tables.
const char* nameOf(StepPart part);

/// Measured floating-point operations per second of `threads` threads with independent fused multiply-adds on
/// the widest vectors of this machine; each counts as two.
double measuredPeak(int threads);
/// The same for one thread, per second of processor time, which excludes other load on the machine.
double measuredPeakOfProcessor();

}  // namespace strandcast
