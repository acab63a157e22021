#pragma once
#include <span>
#include <vector>

#include "core/strand_set.h"
#include "render/hair_bodies.h"

namespace strandcast {

/// How the twist-free frames of guides start where a skinned body's parts carry their roots (BodyBinding).
/// The wire does not say what a root turns with, but where it is does: the more it is where the parts would
/// have it and not where the head would, the more its frame is turned as they are.
class GuideRoots {
 public:
  void setGroom(const StrandSet& guides);
  void setObstacles(std::span<const HairObstacle> obstacles);
  void place(std::span<const PlacedCollider> colliders) { binding_.place(colliders); }

  /// In the groom's frame, perpendicular to the rest tangent.
  const Vec3& restNormal(size_t guide) const { return normals_[guide]; }
  /// Else the root turns with the head.
  bool carries(size_t guide) const { return binding_.holds(guide); }
  /// The normal at a root that is carried and is at `root` (m, world) now, of any length.
  Vec3 normal(size_t guide, const Vec3& root, const Pose& head) const;

 private:
  std::vector<Vec3> rest_;     ///< m, roots of guides that have vertices
  std::vector<Vec3> normals_;  ///< at rest
  std::vector<BodyPart> parts_;
  BodyBinding binding_;
};

}  // namespace strandcast
