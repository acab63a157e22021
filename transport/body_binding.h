#pragma once
#include <memory>
#include <span>
#include <vector>

#include "transport/messages.h"

namespace strandcast {

/// A part of a skinned body: a collider, and its field around the body at rest.
struct BodyPart {
  uint32_t collider = 0;
  std::shared_ptr<const DistanceField> field;
};

/// Whether a shape of a collider that does not follow the head is a field of the body: its origin must be
/// that of its collider.
inline bool isBodyPart(const ContactPrimitive& shape) { return shape.field && shape.a == Vec3(Vec3::Zero()); }
/// The parts of a skinned body among the colliders, in their order.
std::vector<BodyPart> bodyParts(const ColliderSet& set);

/// Binds points of a body to the parts that they move with. The wire has no joints and weights. Instead, a
/// skinned body's parts are colliders with fields that do not follow the head, and a point moves with the
/// parts on whose surfaces it lies at rest.
class BodyBinding {
 public:
  /// Binds nothing.
  BodyBinding() = default;
  /// `positions`: of the body at rest, m. Uses the first kMaxPlacedColliders parts, because a frame has no
  /// more poses.
  BodyBinding(std::span<const Vec3> positions, std::span<const BodyPart> parts);

  bool empty() const { return colliders_.empty(); }
  /// Whether the vertex is bound to any collider.
  bool holds(size_t vertex) const { return !empty() && offsets_[vertex] < offsets_[vertex + 1]; }
  /// Id of the collider with the largest weight at a vertex. Precondition: holds(vertex).
  uint32_t mainCollider(size_t vertex) const;
  /// Sets the poses of the colliders, as a frame has them; those not given keep their pose.
  void setColliderPoses(std::span<const PlacedCollider> colliders);
  /// Position of a vertex, m: the weighted mean of its position on its colliders. `rest` is its position at
  /// rest. And its normal, not normalised. Precondition: holds(vertex).
  Vec3 position(size_t vertex, const Vec3& rest) const;
  Vec3 normal(size_t vertex, const Vec3& rest, const Vec3& normal) const;

 private:
  struct Share {
    uint32_t collider;  ///< index into colliders_
    float weight;
  };
  std::vector<uint32_t> colliders_;  ///< ids
  std::vector<Pose> poses_;
  std::vector<SurfaceBend> bends_;
  std::vector<size_t> offsets_;  ///< per vertex, into shares_; one more than vertices
  std::vector<Share> shares_;
};

}  // namespace strandcast
