#pragma once
#include <span>
#include <vector>

#include "core/strand_set.h"
#include "render/hair_bodies.h"

namespace strandcast {

/// Initial normals of guides' twist-free frames where a skinned body's parts carry the roots (BodyBinding).
/// The wire format has no root rotations, so they are inferred from positions. The closer a root is to its
/// position under the parts, compared with that under the head, the more its normal rotates with the parts.
class GuideRoots {
 public:
  void setGroom(const StrandSet& guides);
  void setObstacles(std::span<const HairObstacle> obstacles);
  void setColliderPoses(std::span<const PlacedCollider> colliders) { binding_.setColliderPoses(colliders); }

  /// In the groom's rest frame, perpendicular to the rest tangent.
  const Vec3& restNormal(size_t guide) const { return normals_[guide]; }
  /// Whether the body's parts carry the guide's root; otherwise the head does.
  bool carries(size_t guide) const { return binding_.holds(guide); }
  /// The normal of a carried root whose position is `root` (m, world); of any length.
  Vec3 normal(size_t guide, const Vec3& root, const Pose& head) const;

 private:
  std::vector<Vec3> rest_;     ///< m, roots of the guides at rest; origin for a guide without vertices
  std::vector<Vec3> normals_;  ///< at rest
  std::vector<BodyPart> parts_;
  BodyBinding binding_;
};

}  // namespace strandcast
