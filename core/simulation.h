#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/backend.h"
#include "core/body_set.h"
#include "core/broad_phase.h"
#include "core/hair_pull.h"
#include "core/measure.h"
#include "core/origin.h"
#include "core/strand_model.h"

namespace strandcast {

/// Runs one groom on one backend with fixed time steps, prescribed bone motion, bodies and parameters.
///
/// A caller sets poses, then calls step(); the backend interpolates motion within the step. The groom's roots
/// and the bodies with `follows_head` move rigidly with the head (bone 0). Vertices that the model pins to
/// other bones move with those bones.
///
/// Its parts are the bodies (BodySet), the origin of the backend's coordinates (Origin) and the hand that
/// pulls hair (HairPull). It prescribes bones and calls the parts in the order of a step.
///
/// Input is validated: the constructor, setHeadPose, setBonePose, addBody, setBodyPose, setBodyBend,
/// pullHair, setParameters, teleport and resumeFrom throw Error on values that are not finite, out of range
/// or of the wrong size. On invalid input they leave the simulation unchanged. Not thread-safe.
class Simulation {
 public:
  /// `backend` and `external_forces` must not have a model loaded yet; the simulation loads it. Throws Error
  /// as checkModel(), checkParameters() and addBody() do. Also throws Error if `backend` is null, or if the
  /// parameters need external forces and `external_forces` is null or the backend takes no accelerations.
  /// `broad_phase`: null = makeAllPairs().
  Simulation(StrandModel model, std::vector<RigidBody> bodies, Parameters parameters,
             std::unique_ptr<Backend> backend, std::unique_ptr<ExternalForces> external_forces = nullptr,
             std::unique_ptr<BroadPhase> broad_phase = nullptr);

  /// Sets the head pose (world) at the end of the next step. Motion within the step is interpolated. Throws
  /// Error as checkPose() does.
  void setHeadPose(const Pose& head);
  const Pose& headPose() const { return bones_begin_[0]; }
  /// Sets the pose of a bone of the model at the end of the next step; bone 0 is the head. A bone without a
  /// new pose stays where it is. Throws Error on an unknown bone and as checkPose() does. resetDiverged()
  /// resets strands that a bone stretches too far.
  void setBonePose(size_t bone, const Pose& pose);
  void setBonePose(const std::string& bone, const Pose& pose);
  /// The bone's pose at the start of the next step. Throws Error on an unknown bone.
  const Pose& bonePose(size_t bone) const;
  /// Poses of the root frames at the start of the next step, one per strand, world, natural order.
  std::vector<Pose> rootPoses() const;
  /// Adds a body from the next step on, at its pose; contact pushes out hair that is inside it. Throws Error
  /// as checkBody() does. The bodies of the constructor have the ids 0, 1, ...
  BodyId addBody(RigidBody body);
  /// Sets a body's pose (world) at the end of the next step. Motion within the step is interpolated from the
  /// pose before. Throws Error on an unknown body, on one that follows the head, and as checkPose() does.
  void setBodyPose(BodyId body, const Pose& pose);
  /// Sets how the body's surface differs from its rest shape at the end of the next step, in the body's
  /// frame. The bend is interpolated linearly within the step and stays until the next call. Contact uses the
  /// bent surface and its motion. Throws Error on an unknown body, on one without `bends`, and if a number is
  /// not finite.
  void setBodyBend(BodyId body, const SurfaceBend& bend);
  /// Pose and bend at the start of the next step. Throws Error on an unknown body.
  const Pose& bodyPose(BodyId body) const;
  const SurfaceBend& bodyBend(BodyId body) const;
  /// Throws Error on an unknown body.
  void removeBody(BodyId body);
  size_t bodies() const { return bodies_.size(); }
  bool hasBody(BodyId body) const { return bodies_.has(body); }
  /// Ids of all bodies, in the order in which they were added.
  std::vector<BodyId> bodyIds() const { return bodies_.ids(); }
  /// The body as it was added. Throws Error on an unknown body.
  const RigidBody& body(BodyId body) const;

  /// Pulls hair with a hand (HairPull) that closes at `from` and is at `to` from the next step on. Repeated
  /// calls with the same `from` and `radius` move the hand; other values close a new hand. `from` and `to`:
  /// m, world, each coordinate within kMaxHandCoordinate; `radius`: 0 to 10 m; `rate`: 0 to 1000 1/s. Throws
  /// Error as checkPull() does, or if the backend takes no accelerations.
  void pullHair(const Vec3& from, float radius, const Vec3& to, float rate);
  /// Opens the hand: no pull from the next step on.
  void releaseHair() { pull_.reset(); }
  /// Number of vertices that the hand pulls; 0 without a hand.
  size_t pulledVertices() const { return pull_ ? pull_->vertices() : 0; }

  /// Throws Error as checkParameters() and the constructor do, and if the solver differs: it is fixed at
  /// construction.
  void setParameters(const Parameters& parameters);
  const Parameters& parameters() const { return parameters_; }

  /// The input of the next step: poses of bones and bodies at its start and end, relative to origin(). Valid
  /// until the next call of a non-const function.
  StepInput nextInput();
  /// Advances by one fixed time step. Neither throws nor allocates.
  void step();
  /// Resets all strands to the rest shape at the present bone poses, without velocity. Opens the hand and
  /// chooses the origin anew.
  void reset();
  /// Resets strands to their rest shape if a vertex is not finite or is farther from the root than twice the
  /// strand's length. Returns their number. Waits for the backend. Allocates only if there are such strands
  /// or the origin changes.
  size_t resetDiverged();
  /// Origin of the backend's coordinates, m, world, whole metres: see Origin. reset(), teleport(),
  /// jumpToPoses() and resumeFrom() choose the origin; resetDiverged() moves it when the head is far from it.
  const Vec3& origin() const { return origin_.position; }
  /// Moves the hair and every bone rigidly so that the head is at `head`, without motion in between. Throws
  /// Error as checkPose() does.
  void teleport(const Pose& head);
  /// A cut: bones and bodies are at once where the setters put them for the end of the next step. Hair moves
  /// rigidly with the bone of its root, beyond a pinned vertex with the bone of that. Its velocities rotate
  /// with it and gain nothing. The air starts from its initial state; a hand stays where it is. Waits for the
  /// backend; allocates. A strand whose bones move differently is stretched between them: the next step, or
  /// resetDiverged(), restores its length.
  void jumpToPoses();

  /// Continues where another simulation of the same model was after `time` s. `state`: the hair, as state()
  /// of that simulation returned it. Bones and bodies are at their newest poses, without motion before; the
  /// air starts from its initial state. Throws Error if the arrays of `state` do not fit the model or are not
  /// finite, or if `time` is negative or not finite.
  void resumeFrom(const StrandState& state, double time);

  double time() const { return time_; }  ///< s, simulated since the start
  uint64_t steps() const { return steps_; }
  const StrandModel& model() const { return *model_; }
  Backend& backend() { return *backend_; }  ///< its coordinates are relative to origin()
  ExternalForces* externalForces() { return external_forces_.get(); }  ///< may be null
  /// Positions after the newest step, m, world, one per vertex in natural order. Valid until the next call.
  /// Waits for the backend.
  std::span<const Vec3> guides() { return guidesOf(0, model_->vertices()); }
  /// The array of guides(), in which only vertices `first` to `first` + `count` - 1 need hold positions of
  /// the newest step. On a GPU no others are copied.
  std::span<const Vec3> guidesOf(size_t first, size_t count);
  /// As Backend::packGuides(). `frame.origin` is set here.
  std::span<const PackedRun> packGuides(const GuideGrid& grid, PackingFrame frame);
  /// Stretch and penetration of the newest guides.
  Measurement measure(StrandRange strands = {});
  StrandState state();  ///< positions in world coordinates; waits for the backend

 private:
  void checkBone(size_t bone, const char* where) const;
  /// Computes the primitives of the next step.
  void placeBodies();
  /// The next step starts at the newest poses of bones and bodies, without motion.
  void advanceMotion();
  /// The rest shape at the present bone poses, without velocity, relative to origin_.
  StrandState restNow() const;
  /// Sets origin_ for a head at this pose. The caller must call uploadState() next and inform the air.
  void chooseOrigin(const Pose& head);
  /// Uploads `state`, which is relative to origin_, and places the bodies. The caller informs the air.
  void uploadState(const StrandState& state);
  void rebaseOrigin();  ///< moves the origin if the head is far from it
  /// Moves hair rigidly with the bones, without motion in between, and resets the air. `motions`: per bone,
  /// from its old place, relative to the origin of the backend's state, to its new one, relative to origin_.
  /// Relative poses are used because world coordinates of a far head are too coarse for the difference.
  void carryHair(std::span<const Pose> motions);
  void addPull(StepInput& input);
  /// Configures external forces and backend for these parameters. Returns whether they are needed. Throws
  /// Error.
  bool configureExternalForces(const Parameters& parameters);

  std::unique_ptr<StrandModel> model_;  ///< at a fixed address: the backend keeps a pointer
  Parameters parameters_;
  Parameters effective_parameters_;  ///< with the substeps that the solver can take: see kLongestSubstep
  std::unique_ptr<Backend> backend_;
  std::unique_ptr<ExternalForces> external_forces_;
  bool has_external_forces_ = false;           ///< the parameters need them
  std::vector<Pose> bones_begin_, bones_end_;  ///< world, one per bone of the model
  std::vector<Pose> bones_begin_local_,
      bones_end_local_;  ///< relative to origin_, as in the newest StepInput
  Origin origin_;
  std::vector<Vec3> world_guides_;  ///< empty while origin_ is the world origin
  std::vector<float> lengths_;      ///< rest length per strand, m
  StrandReach reach_;
  std::vector<Box> strand_boxes_;  ///< per neighbourhood of StrandOrder
  BodySet bodies_;
  std::optional<HairPull> pull_;
  double time_ = 0;
  uint64_t steps_ = 0;
};

}  // namespace strandcast
