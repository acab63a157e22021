#pragma once
#include <span>
#include <vector>

#include "core/triangle_mesh.h"
#include "render/hair_bodies.h"

namespace strandcast {

/// Draws a body where its colliders are. The wire has no joints and weights; but a skinned body's parts are
/// colliders with fields that do not follow the head, and a vertex lies on the surfaces of those that it
/// moves with. A field whose own frame is not that of its collider (ContactPrimitive::a is not zero) is no
/// such part.
class BodyBinding {
 public:
  BodyBinding() = default;
  /// `positions`: of the body at rest, m. Obstacles that are not such fields are no matter.
  BodyBinding(std::span<const Vec3> positions, std::span<const HairObstacle> obstacles);

  bool empty() const { return colliders_.empty(); }
  /// Whether the vertex moves with colliders at all.
  bool holds(size_t vertex) const { return !empty() && offsets_[vertex] < offsets_[vertex + 1]; }
  void place(std::span<const PlacedCollider> colliders);
  /// Where a vertex that it holds is, m, from where it is at rest: the mean of its colliders'. And its
  /// normal, of any length.
  Vec3 position(size_t vertex, const Vec3& rest) const;
  Vec3 normal(size_t vertex, const Vec3& rest, const Vec3& normal) const;

 private:
  struct Share {
    uint32_t collider;  ///< index into colliders_
    float weight;
  };
  std::vector<uint32_t> colliders_;  ///< their ids
  std::vector<Pose> poses_;
  std::vector<SurfaceBend> bends_;
  std::vector<size_t> offsets_;  ///< per vertex, of its shares; one more than vertices
  std::vector<Share> shares_;
};

}  // namespace strandcast
