// Hairs that follow guides from their own rest shape (groom/bound_growth.h), as the renderer keeps them.
#pragma once
#include <cstdint>
#include <memory>
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

/// Bound hairs at rest on the device, and the shaders that grow them: 16 bytes a hair, 40 a vertex. Among
/// obstacles (HairBodies) a hair follows its first guide alone where it would enter one, and vertices still
/// in it are moved out. A vertex may always be as deep as at rest, so that hair at rest is the artist's.
class BoundHairs {
 public:
  /// `hairs`: 1 or more strands of 1 or more vertices, m, groom frame. Throws Error where the device allows
  /// no buffer of that size.
  explicit BoundHairs(const StrandSet& hairs);

  int vertices() const { return vertices_; }  ///< of the hair that has most
  void bind() const;
  /// Grows a vertex of a hair for each invocation. Precondition: GuideNodes::setGroom() carries hairs; among
  /// bodies, computeClosing() for these hairs.
  const gl::Program& program(bool among_bodies) const;
  /// Measures how far vertices at rest are from the bodies that are bound. Precondition: GrowthBlock is
  /// bound.
  void measureRest();
  /// Computes the closing on one guide for `count` hairs of the list, from `first` on. Precondition:
  /// measureRest() for these bodies at rest; bodies, nodes and GrowthBlock are bound.
  void computeClosing(size_t first, size_t count) const;
  size_t bytes() const { return hair_buffer_.bytes() + vertex_buffer_.bytes(); }  ///< device memory

 private:
  /// Runs an invocation for each hair.
  void dispatch(const gl::Program& program, size_t first, size_t count) const;

  gl::Program program_;
  std::unique_ptr<gl::Program> among_bodies_, rest_, closing_;  ///< null until there are bodies
  gl::Buffer hair_buffer_, vertex_buffer_;
  int vertices_ = 0;
  size_t hairs_ = 0, all_vertices_ = 0;
};

}  // namespace strandcast
