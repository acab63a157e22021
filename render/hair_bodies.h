#pragma once
#include <span>
#include <vector>

#include "core/contact_primitive.h"
#include "gl/buffer.h"
#include "gl/program.h"
#include "transport/body_binding.h"

namespace strandcast {

/// Id of an obstacle that is not a collider of a ColliderSet.
constexpr uint32_t kNoCollider = 0xFFFFFFFF;

/// A body for which the penetration of grown hair is resolved.
struct HairObstacle {
  ContactPrimitive shape;    ///< m, in the rest frame of the head, or in the obstacle's own frame
  bool follows_head = true;  ///< otherwise place() sets the pose, or it stays at `pose`
  uint32_t collider = 0;     ///< id in a ColliderSet, by which place() finds it
  Pose pose{};               ///< initial pose where it does not follow the head
  SurfaceBend bend{};        ///< initial bend of a field

  /// Whether place() may move and bend it.
  bool canBend() const { return !follows_head && collider != kNoCollider && shape.field; }
};

/// The obstacles that are parts of a skinned body.
std::vector<BodyPart> bodyParts(std::span<const HairObstacle> obstacles);

/// Keeps grown hair out of bodies, as the simulation keeps guides out. A hair from a seed that would enter a
/// body follows one guide instead of three from before that point on, the more the deeper it would be
/// (kernels/hair.h, closingAsked). A vertex that is still inside is moved out along the surface's normal.
/// Near its root, a hair may be as deep as the root is. Bound hairs (BoundHairs) do the same, but may be as
/// deep as at rest.
class HairBodies {
 public:
  HairBodies();

  /// Throws Error on an invalid shape.
  void setObstacles(std::vector<HairObstacle> obstacles);
  uint32_t revision() const { return revision_; }  ///< counts calls of setObstacles()
  size_t obstacles() const { return obstacles_.size(); }

  /// Sets the obstacles' poses. Colliders that are not obstacles are ignored; obstacles that are not in
  /// `colliders` stay.
  void place(const Pose& head, std::span<const PlacedCollider> colliders = {});
  /// Places those obstacles alone that hair may be in at rest, as they were set: those that follow the head,
  /// parts of a skinned body, and those that were not placed elsewhere. Returns their number. placeAgain()
  /// ends that.
  size_t placeAtRest();
  void placeAgain();
  /// Computes the closing of the first `hairs` hairs of the bound list. Precondition: the guides' nodes and
  /// GrowthBlock are bound. Throws Error where the device does not allow a buffer of that size.
  void computeClosing(size_t hairs, int segments);
  void bind() const;
  size_t bytes() const;  ///< device memory

 private:
  bool holdsHair(size_t obstacle) const;
  size_t write(const Pose& head, std::span<const HairObstacle> obstacles, bool only_holding);

  std::vector<HairObstacle> obstacles_, at_rest_;
  Pose head_;
  uint32_t revision_ = 0;
  ShapeData shapes_;
  std::vector<uint32_t> first_words_;  ///< offset per obstacle in shapes_
  std::vector<uint32_t> bend_words_;   ///< offset of its bend; 0 = it cannot bend
  gl::Program program_;
  gl::Buffer body_buffer_, word_buffer_, hair_buffer_;
};

}  // namespace strandcast
