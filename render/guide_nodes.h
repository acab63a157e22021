#pragma once
#include <span>
#include <vector>

#include "gl/buffer.h"
#include "gl/program.h"
#include "render/guide_roots.h"
#include "transport/messages.h"

namespace strandcast {

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
