#pragma once
#include "gl/program.h"
#include "render/guide_nodes.h"
#include "render/hair_pass.h"
#include "render/mark_settings.h"

namespace strandcast {

/// Draws marks over a picture, with depth test.
class Marks {
 public:
  Marks();
  ~Marks();
  Marks(const Marks&) = delete;
  Marks& operator=(const Marks&) = delete;

  /// `reach`: distance that counts as touching, m. Precondition: the hair was grown for this picture.
  void draw(const MarkSettings& marks, const GuideNodes& nodes, HairPass& hair, float reach) const;

 private:
  gl::Program guides_, tangents_, collided_, inside_;
  GLuint empty_vertices_ = 0;
};

}  // namespace strandcast
