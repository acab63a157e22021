#pragma once
#include <memory>
#include <span>
#include <vector>

#include "core/backend.h"
#include "core/measure.h"

namespace strandcast {

/// A body: shapes that share one rigid motion.
struct RigidBody {
  std::vector<ContactPrimitive> primitives;
  bool follows_head = false;  ///< moves with the head pose; else stays where it is
};

/// Runs one groom on one backend: fixed steps, prescribed head motion, bodies, parameters.
/// The groom's roots and the bodies that follow the head move rigidly with the head pose.
/// What is not finite is refused at the door: setHeadPose, teleport, setParameters and the constructor throw
/// Error on it and leave the simulation as it was.
class Simulation {
 public:
  /// `backend` is empty-handed: the simulation loads the model into it.
  Simulation(StrandModel model, std::vector<RigidBody> bodies, Parameters parameters,
             std::unique_ptr<Backend> backend);

  /// Where the head is to be at the end of the next step. Motion in between is interpolated. Error: see
  /// checkPose.
  void setHeadPose(const Pose& head);
  const Pose& headPose() const { return head_begin_; }
  /// Error: see checkParameters.
  void setParameters(const Parameters& parameters);
  const Parameters& parameters() const { return parameters_; }

  /// What the next step will be given: roots and bodies from where the head is to where it is to be. Valid
  /// until it.
  StepInput nextInput();
  /// One fixed step. Neither throws nor allocates.
  void step();
  /// Back to the rest shape at the present head pose, at rest.
  void reset();
  /// Puts strands with a vertex that is not finite, or farther from the root than the strand is long, back to
  /// their rest shape; gives how many. Waits for the backend. Allocates only when there are some.
  size_t resetBroken();
  /// Carries the hair rigidly to `head` with no motion in between. Error: see checkPose.
  void teleport(const Pose& head);

  double time() const { return time_; }  ///< s, simulated since the start
  uint64_t steps() const { return steps_; }
  const StrandModel& model() const { return model_; }
  Backend& backend() { return *backend_; }
  /// Positions after the newest step, natural order. Waits for the backend.
  std::span<const Vec3> guides() { return backend_->guides(); }
  /// Length and penetration of the newest guides.
  Measurement measure();
  StrandState state();

 private:
  void placeRoots(const Pose& head, std::vector<Pose>& roots) const;
  void placePrimitives();
  void teleport(const Pose& head, const StrandState& state);

  StrandModel model_;
  std::vector<RigidBody> bodies_;
  Parameters parameters_;
  std::unique_ptr<Backend> backend_;
  Pose head_begin_, head_end_;
  std::vector<Pose> roots_begin_, roots_end_;
  std::vector<float> lengths_;  ///< of strands at rest, m
  std::vector<MovingPrimitive> primitives_;
  double time_ = 0;
  uint64_t steps_ = 0;
};

}  // namespace strandcast
