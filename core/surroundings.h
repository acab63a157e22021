#pragma once
#include <span>

#include "core/backend.h"

namespace strandcast {

/// What acts on strands beyond themselves and the bodies: moving air, other hair. Once per step, before the
/// substeps, it gives every vertex an acceleration, which the backend adds to gravity. Implemented in air/.
class Surroundings {
 public:
  virtual ~Surroundings() = default;

  /// Takes what it needs of the groom and of the settings; the state is that of the groom at rest. Throws
  /// Error.
  virtual void load(const StrandModel& model, const Parameters& parameters) = 0;
  /// New settings, which are in range. May allocate; throws Error and leaves all as it was where they do not
  /// fit.
  virtual void configure(const Parameters& parameters) = 0;
  /// The air is as at the start again: after a reset or a teleport.
  virtual void reset() = 0;

  /// Advances by a step and gives accelerations, m/s^2 per vertex, natural order, valid until the next call.
  /// Positions and velocities are those at the start of the step. Neither throws nor allocates.
  virtual std::span<const Vec3> step(const StepInput& input, std::span<const Vec3> positions,
                                     std::span<const Vec3> velocities) = 0;
};

/// Whether the settings ask for any of it. Where not, it is never called and costs nothing.
bool needsSurroundings(const Parameters& parameters);

}  // namespace strandcast
