#pragma once
#include <vector>

#include "core/contact_primitive.h"
#include "gl/buffer.h"
#include "gl/program.h"

namespace strandcast {

/// A body that grown hair is kept out of.
struct HairObstacle {
  ContactPrimitive shape;    ///< m, of the head at rest
  bool follows_head = true;  ///< else it stays
};

/// Keeps grown hair out of bodies as guides are already. A hair that would go into one leaves its three
/// guides for one before, more so the deeper it would go (kernels/hair.h, closingAsked), and what is still
/// inside is moved out along the surface's normal. Near its root a hair may be as deep as the root is.
class HairBodies {
 public:
  HairBodies();

  /// Throws Error where a shape is not sound.
  void setObstacles(std::vector<HairObstacle> obstacles);
  size_t obstacles() const { return obstacles_.size(); }

  void place(const Pose& head);
  /// For the first `hairs` of those that are bound, with the guides' nodes and GrowthBlock. Throws Error
  /// where the device has no buffer so large.
  void find(size_t hairs, int segments);
  void bind() const;
  size_t bytes() const;  ///< of device memory

 private:
  std::vector<HairObstacle> obstacles_;
  ShapeData shapes_;
  std::vector<uint32_t> first_words_;  ///< per obstacle, in shapes_
  gl::Program program_;
  gl::Buffer body_buffer_, word_buffer_, hair_buffer_;
};

}  // namespace strandcast
