#pragma once
#include <memory>
#include <span>
#include <vector>

#include "transport/messages.h"

namespace strandcast {

/// A part of a skinned body: a collider, and a field of it, which lies about the body at rest.
struct BodyPart {
  uint32_t collider = 0;
  std::shared_ptr<const DistanceField> field;
};

/// Whether a shape of a collider that does not follow the head is such a field: not where its own frame is
/// not that of its collider.
inline bool isBodyPart(const ContactPrimitive& shape) { return shape.field && shape.a == Vec3(Vec3::Zero()); }
std::vector<BodyPart> bodyParts(const ColliderSet& set);

/// What of a body moves with which of its parts. The wire has no joints and weights; but a skinned body's
/// parts are colliders with fields that do not follow the head, and a point of the skin lies on the surfaces
/// of those that it moves with.
class BodyBinding {
 public:
  BodyBinding() = default;
  /// `positions`: of the body at rest, m. Of more than kMaxPlacedColliders parts no frame tells: the others
  /// are no matter.
  BodyBinding(std::span<const Vec3> positions, std::span<const BodyPart> parts);

  bool empty() const { return colliders_.empty(); }
  /// Whether the vertex moves with colliders at all.
  bool holds(size_t vertex) const { return !empty() && offsets_[vertex] < offsets_[vertex + 1]; }
  /// Of the colliders of a vertex that it holds, the one that has most of it.
  uint32_t mainCollider(size_t vertex) const;
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
