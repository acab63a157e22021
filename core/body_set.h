// Rigid bodies among hair: their poses and bends, and what a step needs of them.
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/broad_phase.h"
#include "core/contact_primitive.h"
#include "core/origin.h"
#include "core/strand_model.h"

namespace strandcast {

/// A rigid collider: contact primitives that share one rigid motion.
struct RigidBody {
  std::vector<ContactPrimitive> primitives;
  bool follows_head = false;  ///< moves with the head pose; otherwise Simulation::setBodyPose() does
  /// Hair grows on this body. Vertices that lie inside it in the rest shape are exempt from contact down to
  /// their rest depth, for every body (see StrandModel::rest_distance). Only evaluated for the bodies that
  /// the constructor of a Simulation receives.
  bool holds_roots = false;
  Pose pose{};  ///< world; unused if the body follows the head
  /// Whether Simulation::setBodyBend() may bend its distance fields. If so, the fields must not be rotated in
  /// the body's frame.
  bool bends = false;
};

/// Throws Error, naming `where`, as checkPrimitive() and checkPose() do, and on a rotated field in a body
/// with `bends`.
void checkBody(const RigidBody& body, const char* where);

/// Identifies a body of a BodySet. An id is never reused.
using BodyId = uint64_t;

/// The bodies of one simulation, with their motion in the next step and its input to a backend.
///
/// Each body has a pose and a bend at the start and at the end of the next step. Setters change the end. A
/// step is place(), findNear() if strands are bounded, and advance(), which makes the end the new start.
/// primitives() change in place() only. Functions that take `where` throw Error, naming it, on an unknown
/// body. Not thread-safe.
class BodySet {
 public:
  /// `broad_phase`: not null. `neighbourhoods`: greatest number of boxes that findNear() is given.
  BodySet(std::unique_ptr<BroadPhase> broad_phase, size_t neighbourhoods);

  /// Adds a body, at rest at its pose and without a bend. It must have passed checkBody(). Ids are 0, 1, ...
  /// Reserves memory, so that place() and findNear() need not allocate. Throws Error as ShapeData::add()
  /// does, and then adds no body. The caller must call place() next.
  BodyId add(RigidBody body);
  /// Invalidates all first words in shapes(). The caller must call place() next.
  void remove(BodyId body, const char* where);

  size_t size() const { return bodies_.size(); }
  bool has(BodyId body) const { return findOrNull(body) != nullptr; }
  /// Ids of all bodies, in the order in which they were added.
  std::vector<BodyId> ids() const;
  /// The body as it was added.
  const RigidBody& body(BodyId body, const char* where) const;

  /// Sets the pose (world) at the end of the next step. Also throws Error if the body follows the head, and
  /// as checkPose() does.
  void setPose(BodyId body, const Pose& pose, const char* where);
  /// Sets the bend at the end of the next step, in the body's frame. Also throws Error if the body has no
  /// `bends`, or if a number is not finite.
  void setBend(BodyId body, const SurfaceBend& bend, const char* where);
  /// Pose (world) at the start of the next step; `head`: that of the head then.
  const Pose& pose(BodyId body, const Pose& head, const char* where) const;
  /// Bend at the start of the next step.
  const SurfaceBend& bend(BodyId body, const char* where) const;

  /// Ends the step: the next one starts at the newest poses and bends, without motion.
  void advance();
  /// Undoes setPose() and setBend() since the last advance().
  void cancelMotion();

  /// Computes primitives() for a step of `dt` seconds in which the head moves from `head_begin` to `head_end`
  /// (world), relative to `origin`. Writes the bends of the step to shapes().
  void place(const Pose& head_begin, const Pose& head_end, const Origin& origin, float dt);
  /// Result of the newest place(): the primitives of all bodies, in the order of ids(). Invalid from add() or
  /// remove() to the next place().
  std::span<const MovingPrimitive> primitives() const { return primitives_; }
  /// Data of the primitives.
  const ShapeData& shapes() const { return shapes_; }
  /// Finds the primitives() that each neighbourhood of strands may touch in the step. `neighbourhoods`: boxes
  /// swept over the step, m, relative to the origin of place(). The result is valid until the next call.
  const NearBodyLists& findNear(std::span<const Box> neighbourhoods);

  /// StrandModel::rest_distance of the vertices to the bodies with `holds_roots`. Empty if there is none.
  /// `hair_radius`: m. A body that follows the head is in the groom's frame.
  std::vector<float> restDistances(const StrandModel& model, float hair_radius) const;

 private:
  struct Placed {
    BodyId id;
    RigidBody body;
    Pose begin, end;                   ///< world, of the next step; unused if the body follows the head
    SurfaceBend bend_begin, bend_end;  ///< of the next step, in the body's frame
    std::vector<uint32_t> data;        ///< per primitive, first word in shapes_
    std::vector<uint32_t> bends;  ///< per primitive, first word of its MovingBend in shapes_; 0 = not bent
  };

  const Placed* findOrNull(BodyId body) const;  ///< null for an unknown body
  const Placed& find(BodyId body, const char* where) const;
  Placed& find(BodyId body, const char* where);
  /// Adds the body's primitives to shapes_; throws Error.
  void addShapes(Placed& body);
  void rebuildShapes();  ///< all bodies' primitives anew, in order
  void reserve();

  std::vector<Placed> bodies_;
  BodyId next_id_ = 0;
  ShapeData shapes_;
  std::vector<MovingPrimitive> primitives_;
  std::unique_ptr<BroadPhase> broad_phase_;
  size_t neighbourhoods_;
  std::vector<Box> boxes_;  ///< per primitive, swept over the step
  NearBodyLists near_;
};

}  // namespace strandcast
