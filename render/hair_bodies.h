#pragma once
#include <span>
#include <vector>

#include "core/contact_primitive.h"
#include "gl/buffer.h"
#include "gl/program.h"
#include "transport/body_binding.h"

namespace strandcast {

/// Of an obstacle that is no collider of a ColliderSet.
constexpr uint32_t kNoCollider = 0xFFFFFFFF;

/// A body that grown hair is kept out of.
struct HairObstacle {
  ContactPrimitive shape;    ///< m, of the head at rest; else in the obstacle's own frame
  bool follows_head = true;  ///< else it is where place() says, or stays
  uint32_t collider = 0;     ///< of a ColliderSet: what place() knows it by
  Pose pose{};               ///< of one that does not follow the head, at first
  SurfaceBend bend{};        ///< the same, of a field

  /// Whether place() may move, and bend, it.
  bool canBend() const { return !follows_head && collider != kNoCollider && shape.field; }
};

/// Those of a skinned body.
std::vector<BodyPart> bodyParts(std::span<const HairObstacle> obstacles);

/// Keeps grown hair out of bodies as guides are already. A hair that would go into one leaves its three
/// guides for one before, more so the deeper it would go (kernels/hair.h, closingAsked), and what is still
/// inside is moved out along the surface's normal. Near its root a hair may be as deep as the root is.
class HairBodies {
 public:
  HairBodies();

  /// Throws Error where a shape is not sound.
  void setObstacles(std::vector<HairObstacle> obstacles);
  size_t obstacles() const { return obstacles_.size(); }

  /// `colliders` that are not among the obstacles are no matter; obstacles that are not among them stay.
  void place(const Pose& head, std::span<const PlacedCollider> colliders = {});
  /// For the first `hairs` of those that are bound, with the guides' nodes and GrowthBlock. Throws Error
  /// where the device has no buffer so large.
  void find(size_t hairs, int segments);
  void bind() const;
  size_t bytes() const;  ///< of device memory

 private:
  std::vector<HairObstacle> obstacles_;
  ShapeData shapes_;
  std::vector<uint32_t> first_words_;  ///< per obstacle, in shapes_
  std::vector<uint32_t> bend_words_;   ///< likewise of its bend; 0 = it cannot bend
  gl::Program program_;
  gl::Buffer body_buffer_, word_buffer_, hair_buffer_;
};

}  // namespace strandcast
