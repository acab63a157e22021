#pragma once
#include <span>
#include <vector>

#include "gl/buffer.h"
#include "gl/program.h"
#include "render/guide_roots.h"
#include "transport/messages.h"

namespace strandcast {

/// The guides on the device. Per picture, a compute shader evaluates every guide's curve at equal parts of
/// its rest arc length, so that guides with different vertex counts can be mixed: a Catmull-Rom spline with
/// non-uniform knots (finite-difference tangents), its derivative, and a twist-free frame carried from the
/// root by double reflection (kernels/hair.h). Every node is three vec4: position (w: 1 when the guide is
/// finite), derivative along the arc parameter, unit normal.
class GuideNodes {
 public:
  explicit GuideNodes(int segments);

  void setGroom(const StrandSet& guides);
  /// Among which the parts of a skinned body carry the roots on them (GuideRoots).
  void setObstacles(std::span<const HairObstacle> obstacles) { roots_.setObstacles(obstacles); }
  size_t guides() const { return guides_.size(); }
  size_t vertices() const { return vertices_; }
  int segments() const { return segments_; }

  /// `positions` has vertices() entries, world. Not finite ones switch their guide off; returns how many are
  /// off.
  size_t update(std::span<const Vec3> positions, const Pose& head,
                std::span<const PlacedCollider> colliders = {});
  /// Only says how many would be off.
  size_t check(std::span<const Vec3> positions);
  void bind() const;
  size_t bytes() const;  ///< of device memory

 private:
  struct Guide {
    uint32_t first, count, usable;
    uint32_t carried;  ///< GuideRoots does
    /// At the root: perpendicular to the rest tangent, in the groom's frame; carried, of any length, world.
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
