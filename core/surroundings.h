#pragma once
#include "core/backend.h"

namespace strandcast {

/// What acts on strands beyond themselves and the bodies: moving air, other hair. Once per step, before the
/// substeps, it gives every vertex an acceleration, which the backend adds to gravity. Implemented in air/
/// and gpu_compute/.
class Surroundings {
 public:
  virtual ~Surroundings() = default;

  /// Whether there is anything to do with these settings. Where not, nothing else is called: it costs neither
  /// time nor memory.
  virtual bool isNeeded(const Parameters& parameters) const = 0;
  /// Before the first step that needs it, and with new settings, which are in range. The model is the same
  /// each time, `backend` has loaded it; it is told to expect accelerations where step() gives
  /// input.accelerations. May allocate; throws Error and leaves all as it was where they do not fit.
  virtual void configure(const StrandModel& model, const Parameters& parameters, Backend& backend) = 0;
  /// The air is as at the start again: after a reset or a teleport, and where it is needed again. From now on
  /// the backend and StepInput have `origin` (m, world) as theirs, which was the world's before. May
  /// allocate; throws Error.
  virtual void reset(const Vec3& origin) = 0;
  /// The same of `origin` alone, while it is needed: the air goes on as it is and where it is in the world.
  /// May allocate; throws Error.
  virtual void moveOrigin(const Vec3& origin) = 0;

  /// Advances by a step that `backend` is about to do: from its positions and velocities come
  /// input.accelerations, valid until the next call, or the same straight into the backend's own memory.
  /// Neither throws nor allocates.
  virtual void step(StepInput& input, Backend& backend) = 0;
  /// What the newest step() gave, m/s^2 per vertex, natural order, to be looked at before the backend's own
  /// step. Waits where they are elsewhere than in input.accelerations.
  virtual std::span<const Vec3> accelerations() = 0;
};

/// Whether the settings alone ask for any of it.
bool needsSurroundings(const Parameters& parameters);

}  // namespace strandcast
