#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/backend.h"
#include "core/broad_phase.h"
#include "core/measure.h"
#include "core/strand_model.h"

namespace strandcast {

/// A hand that pulls hair: the vertices inside it when it closes keep their offsets from the hand wherever it
/// moves. Each is pulled by a critically damped spring, solved by implicit Euler for the end of a step, so
/// that no rate is too large for the step.
class HairPull {
 public:
  /// Closes about the free vertices within `radius` (m, 0 or more) of `from` (m, world), or about the nearest
  /// free vertex if there is none.
  HairPull(const StrandModel& model, std::span<const Vec3> positions, const Vec3& from, float radius);

  /// `to`: position of the hand, m, world; `rate`: of the spring, 1/s.
  void moveTo(const Vec3& to, float rate);
  /// Whether the hand was constructed with these values.
  bool closedAt(const Vec3& from, float radius) const { return from == from_ && radius == radius_; }
  /// Number of pulled vertices.
  size_t vertices() const { return held_.size(); }

  /// Adds the hand's accelerations over a step of `dt` seconds, m/s^2 per vertex of the model.
  void addTo(std::span<Vec3> accelerations, std::span<const Vec3> positions, std::span<const Vec3> velocities,
             float dt) const;

 private:
  struct Held {
    uint32_t vertex;
    Vec3 place;  ///< m, world, when the hand closed
  };
  std::vector<Held> held_;
  Vec3 from_, way_ = Vec3::Zero();
  float radius_, rate_ = 0;
};

/// A rigid collider: contact primitives that share one rigid motion.
struct RigidBody {
  std::vector<ContactPrimitive> primitives;
  bool follows_head = false;  ///< moves with the head pose; otherwise setBodyPose() moves it
  /// Hair grows on this body. Vertices that lie inside it in the rest shape are exempt from contact down to
  /// their rest depth, for every body (see StrandModel::rest_distance). Only evaluated for the bodies that
  /// the constructor receives.
  bool holds_roots = false;
  Pose pose{};  ///< world; unused if the body follows the head
  /// Whether setBodyBend() may bend its distance fields. If so, the fields must not be rotated in the body's
  /// frame.
  bool bends = false;
};

/// Bound on each coordinate of a hand in Simulation::pullHair(), m.
constexpr float kMaxHandCoordinate = 1000;
/// Bounds on each coordinate for origin rebasing, m. With the head within kNearOrigin of the world origin,
/// the simulation uses the world origin, otherwise an origin near the head. resetDiverged() chooses a new
/// origin when the head is farther than kFarFromOrigin from the current one. See Simulation::origin().
constexpr float kNearOrigin = 4, kFarFromOrigin = 8;

/// Identifies a body of a Simulation. An id is never reused.
using BodyId = uint64_t;

/// Runs one groom on one backend with fixed time steps, prescribed bone motion, bodies and parameters.
///
/// A caller sets poses, then calls step(); the backend interpolates motion within the step. The groom's roots
/// and the bodies with `follows_head` move rigidly with the head (bone 0). Vertices that the model pins to
/// other bones move with those bones.
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
  /// as checkPrimitive() and checkPose() do, and on a rotated field in a body with `bends`. The bodies of the
  /// constructor have the ids 0, 1, ...
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
  bool hasBody(BodyId body) const;
  /// Ids of all bodies, in the order in which they were added.
  std::vector<BodyId> bodyIds() const;
  /// The body as it was added. Throws Error on an unknown body.
  const RigidBody& body(BodyId body) const;

  /// Pulls hair with a hand (HairPull) that closes at `from` and is at `to` from the next step on. Repeated
  /// calls with the same `from` and `radius` move the hand; other values close a new hand. `from` and `to`:
  /// m, world, each coordinate within kMaxHandCoordinate; `radius`: 0 to 10 m; `rate`: 0 to 1000 1/s. Throws
  /// Error if a number is out of range or not finite, or if the backend takes no accelerations.
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
  /// Origin of the backend's coordinates, m, world, whole metres (origin rebasing). Far from the world
  /// origin, positions in float are too coarse: hair would stretch and tremble. reset(), teleport() and
  /// resumeFrom() choose the origin; resetDiverged() moves it when the head is far from it.
  const Vec3& origin() const { return origin_; }
  /// Moves the hair and every bone rigidly so that the head is at `head`, without motion in between. Throws
  /// Error as checkPose() does.
  void teleport(const Pose& head);

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
  std::span<const Vec3> guides();
  /// Stretch and penetration of the newest guides.
  Measurement measure(StrandRange strands = {});
  StrandState state();  ///< positions in world coordinates; waits for the backend

 private:
  struct PlacedBody {
    BodyId id;
    RigidBody body;
    Pose begin, end;                   ///< world, of the next step; unused if the body follows the head
    SurfaceBend bend_begin, bend_end;  ///< of the next step, in the body's frame
    std::vector<uint32_t> data;        ///< per primitive, first word in shapes_
    std::vector<uint32_t> bends;  ///< per primitive, first word of its MovingBend in shapes_; 0 = not bent
  };

  void placePrimitives();
  void checkBone(size_t bone, const char* where) const;
  const PlacedBody* findOrNull(BodyId body) const;  ///< null for an unknown body
  const PlacedBody& find(BodyId body, const char* where) const;
  PlacedBody& find(BodyId body, const char* where);
  /// Reserves memory so that step() need not allocate.
  void reserveForBodies();
  /// Fills near_ with the bodies that each neighbourhood may touch in the next step.
  void findNearBodies();
  /// Adds the body's primitives to shapes_; throws Error.
  void addShapes(PlacedBody& body);
  /// Validates a new body and adds its primitives to shapes_; throws Error.
  PlacedBody placed(RigidBody body, const char* where);
  /// The rest shape at the present bone poses, without velocity, relative to origin_.
  StrandState restNow() const;
  /// Converts a world pose to one relative to origin_.
  Pose toLocal(Pose pose) const;
  /// Sets origin_ for a head at this pose. The caller must call uploadState() next and inform the air.
  void chooseOrigin(const Pose& head);
  /// Uploads `state`, which is relative to origin_, and places the bodies. The caller informs the air.
  void uploadState(const StrandState& state);
  void rebaseOrigin();  ///< moves the origin if the head is far from it
  void addPull(StepInput& input);
  /// Configures external forces and backend for these parameters. Returns whether they are needed. Throws
  /// Error.
  bool configureExternalForces(const Parameters& parameters);

  std::unique_ptr<StrandModel> model_;  ///< at a fixed address: the backend keeps a pointer
  std::vector<PlacedBody> bodies_;
  BodyId next_body_ = 0;
  ShapeData shapes_;
  Parameters parameters_;
  Parameters effective_parameters_;  ///< with the substeps that the solver can take: see kLongestSubstep
  std::unique_ptr<Backend> backend_;
  std::unique_ptr<ExternalForces> external_forces_;
  bool has_external_forces_ = false;  ///< the parameters need them
  std::optional<HairPull> pull_;
  std::vector<Vec3> pull_accelerations_;       ///< of external forces and hand together, m/s^2
  std::vector<Pose> bones_begin_, bones_end_;  ///< world, one per bone of the model
  std::vector<Pose> bones_begin_local_,
      bones_end_local_;  ///< relative to origin_, as in the newest StepInput
  Vec3 origin_ = Vec3::Zero();
  std::vector<Vec3> world_guides_;  ///< empty while origin_ is the world origin
  std::vector<float> lengths_;      ///< rest length per strand, m
  std::vector<MovingPrimitive> primitives_;
  std::unique_ptr<BroadPhase> broad_phase_;
  StrandReach reach_;
  std::vector<Box> body_boxes_, strand_boxes_;  ///< of strands: per neighbourhood of StrandOrder
  NearBodyLists near_;
  double time_ = 0;
  uint64_t steps_ = 0;
};

}  // namespace strandcast
