#pragma once
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/backend.h"
#include "core/hair_pull.h"
#include "core/measure.h"
#include "core/strand_reach.h"
#include "core/surroundings.h"

namespace strandcast {

/// A body: shapes that share one rigid motion.
struct RigidBody {
  std::vector<ContactPrimitive> primitives;
  bool follows_head = false;  ///< moves with the head pose; else as it is told
  /// Hair grows on it: what of the hair is in it at rest is let be, in every body (see
  /// StrandModel::rest_distance). Only of the bodies that a Simulation is made with.
  bool holds_roots = false;
  Pose pose{};  ///< where it is; of a body that follows the head unused
  /// Its fields may be bent, see Simulation::setBodyBend: then they are not rotated in it.
  bool bends = false;
};

/// m, on each axis: see Simulation::pullHair.
constexpr float kFarthestHand = 1000;
/// m, on each axis: a head within kNearOrigin has the world's origin, one beyond an origin of its own, and
/// another one where it has gone farther than kFarFromOrigin from it. See Simulation::origin().
constexpr float kNearOrigin = 4, kFarFromOrigin = 8;

/// A body of a Simulation, as long as it is there. Never given to another one.
using BodyId = uint64_t;

/// Runs one groom on one backend: fixed steps, prescribed head motion, bodies, parameters.
/// The groom's roots and the bodies that follow the head move rigidly with the head pose, what the model has
/// pinned to other bones with theirs.
/// What is not finite, or does not fit, is refused at the door: setHeadPose, setBonePose, addBody,
/// setBodyPose, teleport, setParameters and the constructor throw Error on it and leave the simulation as it
/// was.
class Simulation {
 public:
  /// `backend` and `surroundings` are empty-handed: the simulation loads the model into them. Error as
  /// checkModel(), checkParameters() and addBody(), without a backend, and where the parameters ask for
  /// surroundings and there are none, or the backend does not take them. `broad_phase`:
  /// null = makeAllPairs().
  Simulation(StrandModel model, std::vector<RigidBody> bodies, Parameters parameters,
             std::unique_ptr<Backend> backend, std::unique_ptr<Surroundings> surroundings = nullptr,
             std::unique_ptr<BroadPhase> broad_phase = nullptr);

  /// Where the head is to be at the end of the next step. Motion in between is interpolated. Error: see
  /// checkPose.
  void setHeadPose(const Pose& head);
  const Pose& headPose() const { return bones_begin_[0]; }
  /// The same of another bone of the model, which stays where it is unless told; 0 is the head. Error on an
  /// unknown bone too. Strands that are taken farther than resetBroken() allows are put back by it.
  void setBonePose(size_t bone, const Pose& pose);
  void setBonePose(const std::string& bone, const Pose& pose);
  /// Error on an unknown bone.
  const Pose& bonePose(size_t bone) const;
  /// Where the bones have the strands' roots now, natural order.
  std::vector<Pose> rootPoses() const;
  /// Another body from the next step on, at its pose; hair that is in it then is pushed out. Error: see
  /// checkPrimitive and checkPose. The bodies that the simulation was made with have the ids 0, 1, ...
  BodyId addBody(RigidBody body);
  /// Where a body is to be at the end of the next step, from where it was told to be before. Error on an
  /// unknown body, on one that follows the head, and as checkPose.
  void setBodyPose(BodyId body, const Pose& pose);
  /// How its surface differs from rest at the end of the next step, at its pose; so it stays until it is told
  /// otherwise. It goes there evenly. What is bent pushes hair by where it is then, and takes it along. Error
  /// on an unknown body, on one without `bends`, and where a number is not finite.
  void setBodyBend(BodyId body, const SurfaceBend& bend);
  /// Where it is now, and how it is bent. Error on an unknown body.
  const Pose& bodyPose(BodyId body) const;
  const SurfaceBend& bodyBend(BodyId body) const;
  /// Error on an unknown body.
  void removeBody(BodyId body);
  size_t bodies() const { return bodies_.size(); }
  bool hasBody(BodyId body) const;
  /// Of all there are, in the order in which they were added.
  std::vector<BodyId> bodyIds() const;
  /// As it was added. Error on an unknown body.
  const RigidBody& body(BodyId body) const;

  /// Draws hair to a hand that closes at `from` and is at `to` from the next step on (HairPull). The same
  /// `from` and `radius` as before move the hand; others close it anew. Both places within kFarthestHand of
  /// the origin, `radius` 0 to 10 m, `rate` 0 to 1000 1/s. Error where a number is out of range or not
  /// finite, or on a backend that takes no accelerations.
  void pullHair(const Vec3& from, float radius, const Vec3& to, float rate);
  void letGo() { pull_.reset(); }
  size_t pulledVertices() const { return pull_ ? pull_->vertices() : 0; }

  /// Error: see checkParameters and the constructor; on another solver too, which stays what it was.
  void setParameters(const Parameters& parameters);
  const Parameters& parameters() const { return parameters_; }

  /// What the next step will be given: roots and bodies from where the head is to where it is to be. Valid
  /// until it.
  StepInput nextInput();
  /// One fixed step. Neither throws nor allocates.
  void step();
  /// Back to the rest shape at the present head pose, at rest; a hand lets go.
  void reset();
  /// Puts strands with a vertex that is not finite, or farther from the root than twice the strand's length,
  /// back to their rest shape; gives how many. Waits for the backend. Allocates only when there are some, and
  /// when the origin changes.
  size_t resetBroken();
  /// What the backend's places are told from, m, world, whole metres: floats are coarse far from the world's
  /// origin, and hair would stretch and tremble there. It is chosen by reset() and teleport(), and by
  /// resetBroken() where the head has gone far.
  const Vec3& origin() const { return origin_; }
  /// Carries the hair and every bone rigidly, the head to `head`, with no motion in between. Error: see
  /// checkPose.
  void teleport(const Pose& head);

  /// Goes on where another simulation of the same model was after `time` s: hair as `state` has it (state()
  /// of that one), bones and bodies where they were last told to be, with no motion before. The air is as at
  /// the start. Error where the arrays of `state` are not of the model or not finite, and where `time` is no
  /// time.
  void goOnAs(const StrandState& state, double time);

  double time() const { return time_; }  ///< s, simulated since the start
  uint64_t steps() const { return steps_; }
  const StrandModel& model() const { return *model_; }
  Backend& backend() { return *backend_; }                      ///< has its places from origin()
  Surroundings* surroundings() { return surroundings_.get(); }  ///< may be null
  /// Positions after the newest step, natural order, world; valid until the next call. Waits for the backend.
  std::span<const Vec3> guides();
  /// Length and penetration of the newest guides.
  Measurement measure(StrandRange strands = {});
  StrandState state();  ///< world

 private:
  struct PlacedBody {
    BodyId id;
    RigidBody body;
    Pose begin, end;                   ///< of the next step; not of one that follows the head
    SurfaceBend bend_begin, bend_end;  ///< the same
    std::vector<uint32_t> data;        ///< of its primitives, in shapes_
    std::vector<uint32_t> bends;       ///< the same, 0 of what does not bend
  };

  void placePrimitives();
  void checkBone(size_t bone, const char* where) const;
  const PlacedBody* lookUp(BodyId body) const;  ///< null where there is none
  const PlacedBody& find(BodyId body, const char* where) const;
  PlacedBody& find(BodyId body, const char* where);
  /// So that steps need not allocate.
  void reserveForBodies();
  /// Fills near_ from where roots and bodies are in the next step.
  void findNearBodies();
  /// Adds its shapes to shapes_; throws Error.
  void addShapes(PlacedBody& body);
  /// What is kept of a new body; throws Error.
  PlacedBody placed(RigidBody body, const char* where);
  /// The rest shape where roots and bones are now, at rest, from origin_.
  StrandState restNow() const;
  /// A pose of the world from origin_.
  Pose fromOrigin(Pose pose) const;
  /// Places are told from near the head from now on: goOnFrom() is to follow.
  void chooseOrigin(const Pose& head);
  /// Hair is as `state` says, bodies as they are, both from origin_. The air is to be told.
  void goOnFrom(const StrandState& state);
  void followHead();  ///< with the origin, if it has gone far
  void addPull(StepInput& input);
  /// Readies surroundings and backend for settings that need them; says whether they do. Throws Error.
  bool configureSurroundings(const Parameters& parameters);

  std::unique_ptr<StrandModel> model_;  ///< stays where it is, for the backend
  std::vector<PlacedBody> bodies_;
  BodyId next_body_ = 0;
  ShapeData shapes_;
  Parameters parameters_;
  Parameters stepped_;  ///< the same as backends are given them: see kLongestSubstep
  std::unique_ptr<Backend> backend_;
  std::unique_ptr<Surroundings> surroundings_;
  bool surrounded_ = false;  ///< the settings need them
  std::optional<HairPull> pull_;
  std::vector<Vec3> pull_accelerations_;       ///< of all that acts while a hand pulls
  std::vector<Pose> bones_begin_, bones_end_;  ///< of the model's bones
  std::vector<Pose> told_begin_, told_end_;    ///< the same from origin_, as the newest StepInput has them
  Vec3 origin_ = Vec3::Zero();
  std::vector<Vec3> world_guides_;  ///< empty where origin_ is the world's
  std::vector<float> lengths_;      ///< of strands at rest, m
  std::vector<MovingPrimitive> primitives_;
  std::unique_ptr<BroadPhase> broad_phase_;
  StrandReach reach_;
  std::vector<Box> body_boxes_, strand_boxes_;  ///< strands: per neighbourhood of StrandOrder
  NearBodyLists near_;
  double time_ = 0;
  uint64_t steps_ = 0;
};

}  // namespace strandcast
