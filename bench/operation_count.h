#pragma once
#include <array>

#include "core/backend.h"
#include "core/step_part.h"

namespace strandcast {

/// Floating-point operations of a step, per vertex and substep.
struct OperationCount {
  double all = 0;
  std::array<double, kStepParts> parts{};  ///< by StepPart; they add up to all
};
/// Counts them: the step's own text, as CPU backends have it, run once with numbers that count, over about a
/// thousand of the strands, evenly chosen.
OperationCount countOperations(const StrandModel& model, const StrandState& state, const StepInput& input);

/// What a part is called in tables.
const char* nameOf(StepPart part);

/// Floating-point operations per second that `threads` threads reach with independent fused multiply-adds on
/// the widest vectors of this machine, measured; the pair counts two.
double measuredPeak(int threads);
/// The same of one thread per second of processor time, in which what else the machine does is not counted.
double measuredPeakOfProcessor();

}  // namespace strandcast
