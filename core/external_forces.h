#pragma once
#include "core/backend.h"

namespace strandcast {

class AirSystem;  // air/air_system.h

/// Interface of accelerations besides gravity and contact: moving air, forces between hairs. Once per step,
/// before the substeps, it gives every vertex an acceleration, which the backend adds to gravity.
/// Implementations are in air/ and gpu_compute/.
class ExternalForces {
 public:
  virtual ~ExternalForces() = default;

  /// Whether these parameters need external forces. If not, no other member is called: they cost neither time
  /// nor memory.
  virtual bool isNeeded(const Parameters& parameters) const = 0;
  /// Configures for new parameters, which are valid; called before the first step that needs external forces.
  /// The model is the same in every call, and `backend` has loaded it. Calls backend.prepareAccelerations()
  /// if step() will fill input.accelerations. May allocate. Throws Error, with the strong exception
  /// guarantee, if the parameters do not fit.
  virtual void configure(const StrandModel& model, const Parameters& parameters, Backend& backend) = 0;
  /// Resets the air to its initial state: after a reset or a teleport, and when it is needed again. The
  /// backend and StepInput use `origin` (m, world) from now on; initially it is the world origin. May
  /// allocate; throws Error.
  virtual void reset(const Vec3& origin) = 0;
  /// Changes `origin` (m, world) only, while external forces are needed: the air keeps its state and its
  /// position in the world. May allocate; throws Error.
  virtual void moveOrigin(const Vec3& origin) = 0;

  /// Advances by the step that `backend` is about to do. Computes accelerations from the backend's positions
  /// and velocities. Writes them to input.accelerations, valid until the next call, or directly to the
  /// backend's memory. Neither throws nor allocates.
  virtual void step(StepInput& input, Backend& backend) = 0;
  /// Accelerations of the newest step(), m/s^2 per vertex, natural order. Call it before the backend's own
  /// step. Waits if they are elsewhere than in input.accelerations.
  virtual std::span<const Vec3> accelerations() = 0;

  /// These forces as an air system; null for forces of another kind.
  virtual AirSystem* airSystem() { return nullptr; }
};

/// Whether the parameters alone need external forces.
bool needsExternalForces(const Parameters& parameters);

}  // namespace strandcast
