#pragma once
#include <cstdint>

namespace strandcast {

/// Parts of a step of a block of strands, in the order of its sweeps (core/rod_sweep.inl,
/// core/gauss_seidel_sweep.inl), for operation counts.
enum class StepPart : uint8_t {
  kOther,    ///< once per step: properties of strands, grooming rows; roots; control flow
  kPredict,  ///< inertial points; rod: tangents and parallel transport of frames
  kTwist,    ///< rod: joint strains, elimination of twist
  kBend,  ///< rod: substitution of twist, forces, elimination of bending; gauss_seidel: angular constraints
  kMove,  ///< rod: substitution of bending, elimination of lengths; gauss_seidel: distances, tethers
  kTensions,  ///< rod: substitution of lengths; tension increments with the dense metric or by elimination
  kSecondLengthPass,  ///< rod: second elimination of lengths, with the dense metric or near a body
  kVelocities,        ///< exact lengths, velocities
  kContact,           ///< contact queries, contact solves, penetration resolution
};
constexpr int kStepParts = 9;

/// Marks the code from here to the end of the scope as a part of the step; the innermost scope counts. This
/// one does nothing; bench/lanes_counting.inl shadows it with one that counts operations.
struct [[maybe_unused]] StepScope {
  StepPart part;
};

}  // namespace strandcast
