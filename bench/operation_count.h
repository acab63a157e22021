#pragma once
#include "core/backend.h"

namespace strandcast {

/// Floating-point operations of a step per vertex and substep: the step's own text run once with numbers that
/// count, over about a thousand of the strands, evenly chosen.
double operationsPerVertexSubstep(const StrandModel& model, const StrandState& state, const StepInput& input);

/// Floating-point operations per second that `threads` threads reach with independent fused multiply-adds on
/// the widest vectors of this machine, measured; the pair counts two.
double measuredPeak(int threads);
/// The same of one thread per second of processor time, in which what else the machine does is not counted.
double measuredPeakOfProcessor();

}  // namespace strandcast
