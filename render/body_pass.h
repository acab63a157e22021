#pragma once
#include "gl/program.h"
#include "render/light.h"
#include "render/scene_block.h"
#include "transport/messages.h"

namespace strandcast {

/// Draws the body, the ground and the background.
class BodyPass {
 public:
  BodyPass();
  ~BodyPass();
  BodyPass(const BodyPass&) = delete;
  BodyPass& operator=(const BodyPass&) = delete;

  /// Triangles whose indices are out of range or whose corners are not finite are left out.
  void setBody(const BodyDescription& body);
  /// Which are none at first.
  void setLights(const LightCounts& lights);
  /// Of the body with its head at rest; empty without a body.
  const Box& bounds() const { return bounds_; }

  void drawDepth(const Pose& head, size_t light) const;  ///< from a light of SceneBlock::lights
  void drawBackground() const;
  void drawBody(const Pose& head) const;
  void drawGround() const;

 private:
  void drawMesh(const gl::Program& program, const Pose& head) const;

  gl::Program background_, ground_, body_, depth_;
  gl::Buffer vertices_, indices_;
  GLuint empty_vertices_ = 0, mesh_ = 0;
  GLsizei index_count_ = 0;
  Box bounds_;
};

}  // namespace strandcast
