#include "render/hair_pass.h"

#include <algorithm>

#include "render/shaders.h"

namespace strandcast {
namespace {

constexpr size_t kHairsPerPatch = 64;  // as in hair.tesc
// Mesa's software pipeline spends time with the square of a draw's vertices; other drivers do not mind the
// short draws.
constexpr size_t kPatchesPerDraw = 8;
constexpr int kOpacitySteps = 4;  // of coverage: the thinnest line in the opacity map counts a quarter

}  // namespace

std::vector<gl::ShaderStage> hairStages(const char* defines, const char* fragment) {
  std::vector<gl::ShaderStage> stages{{GL_VERTEX_SHADER, shaders::kHairVert},
                                      {GL_TESS_CONTROL_SHADER, shaders::kHairTesc},
                                      {GL_TESS_EVALUATION_SHADER, shaders::kHairTese, defines}};
  if (fragment != nullptr) stages.push_back({GL_FRAGMENT_SHADER, fragment});
  return stages;
}

HairPass::HairPass()
    : front_("hair front", hairStages("#define FRONT\n", shaders::kHairFrontFrag)),
      opacity_("hair opacity", hairStages("#define OPACITY\n", shaders::kHairOpacityFrag)),
      color_("hair", hairStages("#define COLOR\n", shaders::kHairFrag)) {
  glCreateVertexArrays(1, &empty_vertices_);
  setHairs({});
}

HairPass::~HairPass() { glDeleteVertexArrays(1, &empty_vertices_); }

void HairPass::setHairs(std::vector<Hair> hairs) {
  hairs_ = std::move(hairs);
  hair_buffer_ = gl::Buffer(std::span<const Hair>(hairs_));
}

void HairPass::drawFront(const GuideNodes& nodes) const { draw(front_, nodes, hairs_.size() / 8 + 1, 4); }

void HairPass::drawOpacity(const GuideNodes& nodes, const SceneBlock& block, int map_size) const {
  const float texel = 1.0f / static_cast<float>(map_size);
  opacity_.set("texel", Eigen::Vector2f(texel, texel));
  opacity_.set("steps", static_cast<float>(kOpacitySteps));
  draw(opacity_, nodes, hairsReaching(hairs_, block.hair_color.w() * block.sampling.z(), kOpacitySteps), 2);
}

size_t HairPass::drawColor(const GuideNodes& nodes, const SceneBlock& block, float coverage) const {
  const size_t count = hairsReaching(hairs_, coverage, static_cast<int>(block.sampling.x()));
  glLineWidth(block.sampling.y());
  draw(color_, nodes, count, 1);
  glLineWidth(1);
  return count;
}

void HairPass::draw(const gl::Program& program, const GuideNodes& nodes, size_t count,
                    int node_stride) const {
  bind(program, nodes, count, node_stride);
  drawPatches(count);
}

void HairPass::bind(const gl::Program& program, const GuideNodes& nodes, size_t count,
                    int node_stride) const {
  program.set("hair_count", static_cast<unsigned>(std::min(count, hairs_.size())));
  program.set("segments", static_cast<unsigned>(nodes.segments()));
  program.set("pass_segments", static_cast<unsigned>((nodes.segments() + node_stride - 1) / node_stride));
  program.set("node_stride", static_cast<unsigned>(node_stride));
  nodes.bind();
  hair_buffer_.bindStorage(binding::kHairs);
  program.use();
}

void HairPass::drawPatches(size_t count) const {
  const size_t patches = (std::min(count, hairs_.size()) + kHairsPerPatch - 1) / kHairsPerPatch;
  glBindVertexArray(empty_vertices_);
  glPatchParameteri(GL_PATCH_VERTICES, 1);
  for (size_t first = 0; first < patches; first += kPatchesPerDraw)
    glDrawArrays(GL_PATCHES, static_cast<GLint>(first),
                 static_cast<GLsizei>(std::min(kPatchesPerDraw, patches - first)));
  glBindVertexArray(0);
}

}  // namespace strandcast
