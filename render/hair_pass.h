#pragma once
#include <vector>

#include "gl/program.h"
#include "render/guide_nodes.h"
#include "render/hair_growth.h"
#include "render/scene_block.h"

namespace strandcast {

/// Grows hairs from guide nodes by isoline tessellation, 64 hairs a patch, and draws them as lines.
class HairPass {
 public:
  HairPass();
  ~HairPass();
  HairPass(const HairPass&) = delete;
  HairPass& operator=(const HairPass&) = delete;

  void setHairs(std::vector<Hair> hairs);
  const std::vector<Hair>& hairs() const { return hairs_; }

  /// Depth of the hair nearest to the light, from a part of the hairs.
  void drawFront(const GuideNodes& nodes) const;
  void drawOpacity(const GuideNodes& nodes, const SceneBlock& block, int map_size) const;
  /// `coverage` is the largest part of a line's width that a hair of width 1 has in the picture. Returns how
  /// many hairs were drawn.
  size_t drawColor(const GuideNodes& nodes, const SceneBlock& block, float coverage) const;

  /// Makes `program` (of hairStages) current with the buffers and uniforms for the first `count` hairs, one
  /// vertex at every `node_stride`-th node.
  void bind(const gl::Program& program, const GuideNodes& nodes, size_t count, int node_stride) const;
  void drawPatches(size_t count) const;

 private:
  void draw(const gl::Program& program, const GuideNodes& nodes, size_t count, int node_stride) const;

  std::vector<Hair> hairs_;
  gl::Buffer hair_buffer_;
  gl::Program front_, opacity_, color_;
  GLuint empty_vertices_ = 0;
};

/// The stages that grow hair; `defines` as hair.tese lists them. `fragment` may be null.
std::vector<gl::ShaderStage> hairStages(const char* defines, const char* fragment);

}  // namespace strandcast
