#pragma once
#include <cstdint>

namespace strandcast {

/// The parts of a step of a block of strands, which follow its sweeps: core/rod_sweep.inl and
/// core/gauss_seidel_sweep.inl.
enum class StepPart : uint8_t {
  kOther,    ///< once a step: what strands are like, what grooming makes of them; the roots; what is decided
  kPredict,  ///< inertial points; of rod the tangents and frames carried along
  kTwist,    ///< of rod: joint strains, the twist system eliminated
  kBend,     ///< of rod: twist substituted, forces, the bending system eliminated; else the angular sweeps
  kMove,     ///< of rod: the bending system substituted, that of lengths eliminated; else distances, tethers
  kPulls,    ///< of rod: the lengths' system substituted, and the pulls of violent and of taut strands
  kAgain,    ///< of rod: the lengths' system eliminated again where strands are violent or near a body
  kVelocities,  ///< exact lengths, velocities
  kContact,     ///< bodies: who is near, touch, held, turned out
};
constexpr int kStepParts = 9;

/// Where the text of a step says of what part it is from here to the end of the scope; the innermost holds.
/// It is nothing here. In front of it bench/lanes_counting.inl has one that counts, of the same name.
struct [[maybe_unused]] StepScope {
  StepPart part;
};

}  // namespace strandcast
