#pragma once
#include <memory>
#include <span>
#include <vector>

#include "core/strand_set.h"
#include "gl/buffer.h"
#include "gl/program.h"
#include "render/hair_bodies.h"
#include "render/hair_growth.h"
#include "transport/messages.h"

namespace strandcast {

/// Frames of guides' roots where a skinned body's parts carry them (BodyBinding). The wire format has no root
/// rotations, so they are inferred from positions. The closer a root is to its position under the parts,
/// compared with that under the head, the more its frame rotates with the parts.
class GuideRoots {
 public:
  void setGroom(const StrandSet& guides);
  void setObstacles(std::span<const HairObstacle> obstacles);
  void setColliderPoses(std::span<const PlacedCollider> colliders) { binding_.setColliderPoses(colliders); }

  /// In the groom's rest frame, perpendicular to the rest tangent.
  const Vec3& restNormal(size_t guide) const { return frames_[guide].normal; }
  /// Whether the body's parts carry the guide's root; otherwise the head does.
  bool carries(size_t guide) const { return binding_.holds(guide); }
  /// The normal of a carried root whose position is `root` (m, world); of any length.
  Vec3 normal(size_t guide, const Vec3& root, const Pose& head) const;
  /// The motion from rest of a carried root whose position is `root`: its place is where the parts and the
  /// head carry it, which the error of a codec does not move.
  Pose motion(size_t guide, const Vec3& root, const Pose& head) const;

 private:
  float shareOfParts(size_t guide, const Vec3& root, const Pose& head) const;
  Vec3 carried(size_t guide, const Vec3& direction, float share, const Pose& head) const;

  std::vector<Vec3> rest_;         ///< m, roots of the guides at rest; origin for a guide without vertices
  std::vector<RootFrame> frames_;  ///< at rest
  std::vector<BodyPart> parts_;
  BodyBinding binding_;
};

/// The guides on the device. Per picture, a compute shader evaluates every guide's curve at equal parts of
/// its rest arc length, so that guides of different vertex counts can be mixed. The curve is a Catmull-Rom
/// spline with non-uniform knots (finite-difference tangents). Its twist-free frame is carried from the root
/// by double reflection (kernels/hair.h). A node is three vec4: position (w: 1 where the guide is usable),
/// derivative with respect to the arc parameter, unit normal.
///
/// Bound hairs also need each node at rest and its motion from there (groom/bound_growth.h): three more vec4,
/// position at rest (w: length of the guide, m), position (w: 1 where usable) and rotation, in a buffer of
/// their own. The same shader makes the nodes at rest, so a guide at rest moves its hairs by nothing. A guide
/// near rest counts as at rest (motionShare), so the error of a codec does not move them either.
class GuideNodes {
 public:
  /// `segments`: per guide, at least 1; a guide has segments + 1 nodes. Throws Error.
  explicit GuideNodes(int segments);

  /// Sets the guides at rest. `carry_hairs`: whether bound hairs follow them. Throws Error where the device
  /// allows no buffer of that size.
  void setGroom(const StrandSet& guides, bool carry_hairs = false);
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
    float root_normal[3];
    float length;  ///< m, at rest
    /// The root's motion from the groom's rest frame to the world; only where hairs are carried.
    float root_rotation[4], root_position[4];
  };

  void makeRestNodes(std::span<const Vec3> positions);
  void dispatch(const gl::Program& program) const;

  int segments_;
  size_t vertices_ = 0;
  bool carries_hairs_ = false;
  std::vector<Guide> guides_;
  GuideRoots roots_;
  gl::Program program_;
  std::unique_ptr<gl::Program> rest_program_, carrying_program_;  ///< null until hairs are carried
  gl::Buffer position_buffer_, knot_buffer_, guide_buffer_, node_buffer_, motion_buffer_;
};

}  // namespace strandcast
