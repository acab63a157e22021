#pragma once
#include <span>
#include <vector>

#include "core/strand_set.h"
#include "gl/buffer.h"
#include "gl/program.h"
#include "render/hair_bodies.h"
#include "transport/messages.h"

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

/// The guides on the device. Per picture, a compute shader evaluates every guide's curve at equal parts of
/// its rest arc length, so that guides of different vertex counts can be mixed. The curve is a Catmull-Rom
/// spline with non-uniform knots (finite-difference tangents). Its twist-free frame is carried from the root
/// by double reflection (kernels/hair.h). A node is three vec4: position (w: 1 where the guide is usable),
/// derivative with respect to the arc parameter, unit normal.
class GuideNodes {
 public:
  /// `segments`: per guide, at least 1; a guide has segments + 1 nodes. Throws Error.
  explicit GuideNodes(int segments);

  /// Sets the guides at rest. Throws Error where the device allows no buffer of that size.
  void setGroom(const StrandSet& guides);
  /// Obstacles; parts of a skinned body among them carry the roots on them (GuideRoots).
  void setObstacles(std::span<const HairObstacle> obstacles) { roots_.setObstacles(obstacles); }
  size_t guides() const { return guides_.size(); }
  size_t vertices() const { return vertices_; }
  int segments() const { return segments_; }

  /// `positions`: vertices() entries, m, world. A position that is not finite, or is 1e6 m or farther from
  /// the origin on an axis, disables its guide. Returns the number of disabled guides; 0 where the size does
  /// not match.
  size_t update(std::span<const Vec3> positions, const Pose& head,
                std::span<const PlacedCollider> colliders = {});
  /// Returns that number without updating the nodes.
  size_t check(std::span<const Vec3> positions);
  void bind() const;
  size_t bytes() const;  ///< device memory

 private:
  struct Guide {
    uint32_t first, count, usable;
    uint32_t carried;  ///< root_normal is from GuideRoots, in world space
    /// At the root, perpendicular to the rest tangent. Groom's rest frame; where `carried`, world and of any
    /// length.
    float root_normal[4];
  };

  int segments_;
  size_t vertices_ = 0;
  std::vector<Guide> guides_;
  GuideRoots roots_;
  gl::Program program_;
  gl::Buffer position_buffer_, knot_buffer_, guide_buffer_, node_buffer_;
};

}  // namespace strandcast
