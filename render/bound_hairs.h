// Hairs that follow guides from their own rest shape (groom/bound_growth.h), as the renderer keeps them.
#pragma once
#include <cstdint>
#include <vector>

#include "gl/buffer.h"
#include "gl/program.h"
#include "render/hair_growth.h"
#include "transport/messages.h"

namespace strandcast {

/// The hairs of a description as a picture draws them, in their order; Hair::bound is the index plus 1. A
/// hair has the width of its radii, else `hair_width` (m), times growth.thickness. Maps are looked up at its
/// uv, else at its guides. Its colour replaces the material's; without one, it differs from its neighbours by
/// its id, else by its index. Hairs without a width are left out.
///
/// Precondition: checkHairs() (transport/codec/hair_codec.h) accepts the hairs with these guides.
std::vector<Hair> boundHairs(const HairDescription& hairs, const StrandSet& guides, const HairGrowth& growth,
                             float hair_width);

/// Bound hairs at rest on the device, and the shader that grows them: 16 bytes a hair, 32 a vertex. Obstacles
/// do not move them: they move their guides, and at rest hairs are as the artist made them.
class BoundHairs {
 public:
  /// `hairs`: 1 or more strands of 1 or more vertices, m, groom frame. Throws Error where the device allows
  /// no buffer of that size.
  explicit BoundHairs(const StrandSet& hairs);

  int vertices() const { return vertices_; }  ///< of the hair that has most
  void bind() const;
  /// Grows a vertex of a hair for each invocation. Precondition: GuideNodes::setGroom() carries hairs.
  const gl::Program& program() const { return program_; }
  size_t bytes() const { return hair_buffer_.bytes() + vertex_buffer_.bytes(); }  ///< device memory

 private:
  gl::Program program_;
  gl::Buffer hair_buffer_, vertex_buffer_;
  int vertices_ = 0;
};

}  // namespace strandcast
