#include "render/hair_pass.h"

#include <algorithm>
#include <numeric>
#include <string>

#include "render/scene_block.h"
#include "render/shaders.h"

namespace strandcast {
namespace {

constexpr size_t kGrowthGroupSize = 256;  // must equal local_size_x of hair_growth.comp and bound_growth.comp
constexpr size_t kVertexBytes = 2 * sizeof(float[4]);

size_t maxVertices() {
  GLint64 bytes = 0;
  GLint groups = 0;
  glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &bytes);
  glGetIntegeri_v(GL_MAX_COMPUTE_WORK_GROUP_COUNT, 0, &groups);
  const size_t most =
      std::min(static_cast<size_t>(bytes) / kVertexBytes, static_cast<size_t>(groups) * kGrowthGroupSize);
  return std::min(most, size_t{1} << 31);
}

}  // namespace

void HairVertices::makeRoom(size_t count, int max_nodes) {
  if (max_nodes == max_nodes_ && count <= room_) return;
  // Grows by half, so that approaching the hair does not reallocate at every picture.
  count = std::max(count, max_nodes == max_nodes_ ? room_ + room_ / 2 : 0);
  chunks_.clear();
  room_ = count;
  max_nodes_ = max_nodes;
  const size_t most = std::max<size_t>(maxVertices() / static_cast<size_t>(max_nodes), 1);
  for (size_t first = 0; first < count; first += most) {
    const size_t hairs = std::min(most, count - first);
    chunks_.push_back({first, hairs, gl::Buffer(hairs * max_nodes * kVertexBytes, nullptr, 0)});
  }
}

void HairVertices::grow(const gl::Program& program, size_t first, size_t count, int nodes, int node_stride) {
  makeRoom(count, nodes);
  nodes_per_hair_ = (nodes - 1 + node_stride - 1) / node_stride + 1;
  first_ = first;
  hairs_ = count;
  program.set("node_stride", static_cast<unsigned>(node_stride));
  program.set("nodes_per_hair", static_cast<unsigned>(nodes_per_hair_));
  program.use();
  for (const Chunk& chunk : chunks_) {
    if (chunk.first >= count) break;
    const size_t hairs = std::min(chunk.hairs, count - chunk.first);
    program.set("first_hair", static_cast<unsigned>(first + chunk.first));
    program.set("hair_count", static_cast<unsigned>(hairs));
    chunk.vertices.bindStorage(binding::kHairVertices);
    glDispatchCompute(
        static_cast<GLuint>((hairs * nodes_per_hair_ + kGrowthGroupSize - 1) / kGrowthGroupSize), 1, 1);
  }
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

size_t HairVertices::bytes() const {
  size_t sum = 0;
  for (const Chunk& chunk : chunks_) sum += chunk.vertices.bytes();
  return sum;
}

namespace {

constexpr size_t kHairsPerPatch = 64, kSegmentsPerPatch = 64;  // as in hair.tesc
// Mesa's software pipeline takes time quadratic in a draw's vertices; other drivers handle short draws
// equally well.
constexpr size_t kPatchesPerDraw = 8;

unsigned segmentsOf(const GuideNodes& nodes, int node_stride) {
  return static_cast<unsigned>((nodes.segments() + node_stride - 1) / node_stride);
}

/// Adds the defines to the fragment shader, the last stage, which shades too.
std::vector<gl::ShaderStage> colored(std::vector<gl::ShaderStage> stages, const std::string& defines) {
  stages.back().defines = defines;
  return stages;
}

}  // namespace

std::vector<gl::ShaderStage> grownStages(const std::string& defines, const char* fragment) {
  return {{GL_VERTEX_SHADER, shaders::kHairStrandVert, defines}, {GL_FRAGMENT_SHADER, fragment}};
}

std::vector<gl::ShaderStage> tessellatedStages(const char* defines, const char* fragment) {
  std::vector<gl::ShaderStage> stages{{GL_VERTEX_SHADER, shaders::kHairVert},
                                      {GL_TESS_CONTROL_SHADER, shaders::kHairTesc},
                                      {GL_TESS_EVALUATION_SHADER, shaders::kHairTese, defines}};
  if (fragment != nullptr) stages.push_back({GL_FRAGMENT_SHADER, fragment});
  return stages;
}

gl::Program HairPass::colorProgram(GrowthPath path, HairGeometry geometry, HairShading shading,
                                   const LightCounts& lights) {
  const std::string color = "#define COLOR\n" + lightDefines(lights) +
                            (shading == HairShading::kFragment ? "#define PER_FRAGMENT\n" : "");
  const std::string strip = geometry == HairGeometry::kStrips ? "#define STRIP\n" : "";
  return {"hair",
          colored(path == GrowthPath::kTessellator ? tessellatedStages(color.c_str(), shaders::kHairFrag)
                                                   : grownStages(color + strip, shaders::kHairFrag),
                  color)};
}

HairPass::Programs HairPass::makePrograms(GrowthPath path, HairGeometry geometry, HairShading shading,
                                          const LightCounts& lights) {
  const auto stages = [path](const char* defines, const char* fragment) {
    return path == GrowthPath::kTessellator ? tessellatedStages(defines, fragment)
                                            : grownStages(defines, fragment);
  };
  return {{"hair front", stages("#define FRONT\n", shaders::kHairFrontFrag)},
          {"hair opacity", stages("#define OPACITY\n", shaders::kHairOpacityFrag)},
          colorProgram(path, geometry, shading, lights)};
}

HairPass::HairPass(GrowthPath path, HairGeometry geometry, HairShading shading, const LightCounts& lights)
    : path_(path),
      geometry_(path == GrowthPath::kTessellator ? HairGeometry::kLines : geometry),
      shading_(shading),
      lights_(lights),
      block_buffer_(sizeof(GrowthBlock), nullptr, GL_DYNAMIC_STORAGE_BIT),
      marks_block_buffer_(sizeof(GrowthBlock), nullptr, GL_DYNAMIC_STORAGE_BIT),
      free_("hair growth", {{GL_COMPUTE_SHADER, shaders::kHairGrowthComp}}),
      among_bodies_("hair growth among bodies",
                    {{GL_COMPUTE_SHADER, shaders::kHairGrowthComp, "#define BODIES\n"}}),
      programs_(makePrograms(path, geometry, shading, lights)) {
  glCreateVertexArrays(1, &empty_vertices_);
  setHairs({}, {});
}

HairPass::~HairPass() { glDeleteVertexArrays(1, &empty_vertices_); }

void HairPass::setLights(const LightCounts& lights) {
  lights_ = lights;
  programs_.color = colorProgram(path_, geometry_, shading_, lights);
  if (bound_programs_)
    bound_programs_->color = colorProgram(GrowthPath::kCompute, geometry_, shading_, lights);
}

void HairPass::setHairs(std::vector<Hair> hairs, const HairGrowth& growth,
                        std::unique_ptr<BoundHairs> bound) {
  if (bound && path_ == GrowthPath::kTessellator && !bound_programs_)
    bound_programs_ =
        std::make_unique<Programs>(makePrograms(GrowthPath::kCompute, geometry_, shading_, lights_));
  bound_ = std::move(bound);
  bound_rest_ = 0;
  bound_vertices_ = HairVertices();
  hairs_ = std::move(hairs);
  hair_buffer_ = gl::Buffer(std::span<const Hair>(hairs_));
  std::vector<uint32_t> all(hairs_.size());
  std::iota(all.begin(), all.end(), 0u);
  list_buffer_ = gl::Buffer(std::span<const uint32_t>(all));
  select(all);
  for (int i = 0; i < 3; ++i) block_.profile[i] = growth.lock_profile[i];
  if (growth.curl_example) block_.example = growth.curl_example->samples;
}

void HairPass::select(std::span<const uint32_t> hairs) {
  list_.assign(hairs.begin(), hairs.end());
  bound_before_.clear();
  listed_seeded_ = list_.size();
  if (bound_) {
    bound_before_.push_back(0);
    for (const uint32_t hair : hairs)
      bound_before_.push_back(bound_before_.back() + (hairs_[hair].bound > 0));
    listed_seeded_ -= bound_before_.back();
    std::stable_partition(list_.begin(), list_.end(), [&](uint32_t hair) { return hairs_[hair].bound == 0; });
  }
  list_buffer_.write(std::span<const uint32_t>(list_));
}

HairPass::Kinds HairPass::kindsOf(size_t hairs) const {
  if (bound_before_.empty()) return {hairs, 0};
  const size_t bound = bound_before_[std::min(hairs, list_.size())];
  return {hairs - bound, bound};
}

void HairPass::grow(const GuideNodes& nodes, const HairDetail& detail) {
  block_.segments = static_cast<uint32_t>(nodes.segments());
  block_.bodies = static_cast<uint32_t>(keep_out_ ? bodies_.obstacles() : 0);
  block_buffer_.write(std::span<const GrowthBlock>(&block_, 1));
  bindHair(nodes);
  const Kinds count = kindsOf(detail.hairs);
  if (block_.bodies > 0) bodies_.computeClosing(count.seeded, nodes.segments());
  if (path_ == GrowthPath::kCompute)
    vertices_.grow(block_.bodies > 0 ? among_bodies_ : free_, 0, count.seeded, nodes.segments() + 1,
                   detail.node_stride);
  if (bound_) growBound(detail);
}

/// Precondition: bindHair() and block_ in its buffer.
void HairPass::growBound(const HairDetail& detail) {
  const size_t count = kindsOf(detail.hairs).bound;
  const bool among_bodies = block_.bodies > 0;
  bound_->bind();
  if (among_bodies && bound_rest_ != bodies_.revision()) {
    GrowthBlock at_rest = block_;
    at_rest.bodies = static_cast<uint32_t>(bodies_.placeAtRest());
    block_buffer_.write(std::span<const GrowthBlock>(&at_rest, 1));
    bound_->measureRest();
    block_buffer_.write(std::span<const GrowthBlock>(&block_, 1));
    bodies_.placeAgain();
    bound_rest_ = bodies_.revision();
  }
  if (among_bodies) bound_->computeClosing(listed_seeded_, count);
  bound_vertices_.grow(bound_->program(among_bodies), listed_seeded_, count, bound_->vertices(),
                       detail.vertex_stride);
}

size_t HairPass::bytes() const {
  return hair_buffer_.bytes() + list_buffer_.bytes() + vertices_.bytes() + bound_vertices_.bytes() +
         bodies_.bytes() + (bound_ ? bound_->bytes() : 0);
}

void HairPass::bindForMarks(const GuideNodes& nodes) {
  bindHair(nodes);
  GrowthBlock block = block_;
  block.segments = static_cast<uint32_t>(nodes.segments());
  block.bodies = static_cast<uint32_t>(bodies_.obstacles());
  marks_block_buffer_.write(std::span<const GrowthBlock>(&block, 1));
  glBindBufferBase(GL_UNIFORM_BUFFER, binding::kGrowth, marks_block_buffer_.id());
}

void HairPass::bindHair(const GuideNodes& nodes) const {
  glBindBufferBase(GL_UNIFORM_BUFFER, binding::kGrowth, block_buffer_.id());
  nodes.bind();
  bodies_.bind();
  hair_buffer_.bindStorage(binding::kHairs);
  list_buffer_.bindStorage(binding::kHairList);
}

void HairPass::drawFront(const GuideNodes& nodes, const HairDetail& detail, size_t light, float line) const {
  for (const Programs* programs : {&programs_, &boundPrograms()})
    programs->front.set("map_light", static_cast<int>(light));
  glLineWidth(line);
  drawBoth(&Programs::front, nodes, detail, false);
  glLineWidth(1);
}

void HairPass::drawOpacity(const GuideNodes& nodes, const HairDetail& detail, size_t light, int map_size,
                           float line) const {
  for (const Programs* programs : {&programs_, &boundPrograms()}) {
    programs->opacity.set("map_light", static_cast<int>(light));
    programs->opacity.set("map_size", static_cast<float>(map_size));
    programs->opacity.set("line_texels", line);
  }
  glLineWidth(line);
  drawBoth(&Programs::opacity, nodes, detail, false);
  glLineWidth(1);
}

void HairPass::drawColor(const GuideNodes& nodes, const SceneBlock& block, const HairDetail& detail) const {
  glLineWidth(block.sampling.y());
  drawBoth(&Programs::color, nodes, detail, geometry_ == HairGeometry::kStrips);
  glLineWidth(1);
}

void HairPass::drawBoth(gl::Program Programs::*program, const GuideNodes& nodes, const HairDetail& detail,
                        bool strips) const {
  draw(programs_.*program, nodes, detail, strips);
  if (!bound_programs_) return;
  const gl::Program& for_bound = (*bound_programs_).*program;
  bind(for_bound, nodes, detail);
  drawGrown(for_bound, bound_vertices_, kindsOf(detail.hairs).bound, strips);
}

void HairPass::draw(const gl::Program& program, const GuideNodes& nodes, const HairDetail& detail,
                    bool strips) const {
  bind(program, nodes, detail);
  if (path_ == GrowthPath::kTessellator) return drawPatches(nodes, detail);
  const Kinds count = kindsOf(detail.hairs);
  drawGrown(program, vertices_, count.seeded, strips);
  drawGrown(program, bound_vertices_, count.bound, strips);
}

void HairPass::bind(const gl::Program& program, const GuideNodes& nodes, const HairDetail& detail) const {
  program.set("hair_count", static_cast<unsigned>(kindsOf(detail.hairs).seeded));
  program.set("pass_segments", segmentsOf(nodes, detail.node_stride));
  program.set("node_stride", static_cast<unsigned>(detail.node_stride));
  program.set("threshold", detail.threshold);
  bindHair(nodes);
  program.use();
}

void HairPass::drawPatches(const GuideNodes& nodes, const HairDetail& detail) const {
  const size_t along = (segmentsOf(nodes, detail.node_stride) + kSegmentsPerPatch - 1) / kSegmentsPerPatch;
  const size_t patches = (kindsOf(detail.hairs).seeded + kHairsPerPatch - 1) / kHairsPerPatch * along;
  glBindVertexArray(empty_vertices_);
  glPatchParameteri(GL_PATCH_VERTICES, 1);
  for (size_t first = 0; first < patches; first += kPatchesPerDraw)
    glDrawArrays(GL_PATCHES, static_cast<GLint>(first),
                 static_cast<GLsizei>(std::min(kPatchesPerDraw, patches - first)));
  glBindVertexArray(0);
}

void HairPass::drawGrown(const gl::Program& program, const HairVertices& vertices, size_t count,
                         bool strips) const {
  const GLsizei nodes = vertices.nodesPerHair();
  program.set("nodes_per_hair", static_cast<unsigned>(nodes));
  glBindVertexArray(empty_vertices_);
  for (const HairVertices::Chunk& chunk : vertices.chunks()) {
    if (chunk.first >= std::min(count, vertices.hairs())) break;
    const size_t hairs = std::min(chunk.hairs, std::min(count, vertices.hairs()) - chunk.first);
    program.set("first_hair", static_cast<unsigned>(vertices.first() + chunk.first));
    chunk.vertices.bindStorage(binding::kHairVertices);
    glDrawArraysInstanced(strips ? GL_TRIANGLE_STRIP : GL_LINE_STRIP, 0, strips ? 2 * nodes : nodes,
                          static_cast<GLsizei>(hairs));
  }
  glBindVertexArray(0);
}

namespace {

constexpr float kTangentLength = 0.01f, kPointPixels = 5, kInsidePixels = 3;
constexpr float kInsideSlack = 1e-5f;  // m, tolerance for rounding

gl::Program markProgram(const char* name, const char* defines) {
  return {name,
          {{GL_VERTEX_SHADER, shaders::kMarksVert, defines}, {GL_FRAGMENT_SHADER, shaders::kMarksFrag}}};
}

}  // namespace

Marks::Marks()
    : guides_(markProgram("guides", "#define GUIDES\n")),
      tangents_(markProgram("tangents", "#define TANGENTS\n")),
      collided_(markProgram("collided vertices", "#define COLLIDED\n")),
      inside_(markProgram("vertices inside", "#define INSIDE\n")) {
  glCreateVertexArrays(1, &empty_vertices_);
}

Marks::~Marks() { glDeleteVertexArrays(1, &empty_vertices_); }

void Marks::draw(const MarkSettings& marks, const GuideNodes& nodes, HairPass& hair, float reach) const {
  const auto guides = static_cast<GLsizei>(nodes.guides());
  if (guides == 0) return;
  hair.bindForMarks(nodes);
  glBindVertexArray(empty_vertices_);
  glEnable(GL_PROGRAM_POINT_SIZE);
  if (marks.guides) {
    guides_.use();
    glDrawArraysInstanced(GL_LINE_STRIP, 0, nodes.segments() + 1, guides);
  }
  if (marks.tangents) {
    tangents_.set("size", kTangentLength);
    tangents_.use();
    glDrawArraysInstanced(GL_LINES, 0, 2 * (nodes.segments() / 4 + 1), guides);
  }
  if (marks.collided) {
    collided_.set("size", kPointPixels);
    collided_.set("reach", reach);
    collided_.use();
    glDrawArrays(GL_POINTS, 0, static_cast<GLsizei>(nodes.vertices()));
  }
  if (marks.inside) {
    inside_.set("size", kInsidePixels);
    inside_.set("reach", kInsideSlack);
    inside_.use();
    for (const HairVertices* grown : {&hair.vertices(), &hair.boundVertices()}) {
      inside_.set("nodes_per_hair", static_cast<unsigned>(grown->nodesPerHair()));
      for (const HairVertices::Chunk& chunk : grown->chunks()) {
        if (chunk.first >= grown->hairs()) break;
        chunk.vertices.bindStorage(binding::kHairVertices);
        inside_.set("first_hair", static_cast<unsigned>(grown->first() + chunk.first));
        glDrawArraysInstanced(GL_POINTS, 0, grown->nodesPerHair(),
                              static_cast<GLsizei>(std::min(chunk.hairs, grown->hairs() - chunk.first)));
      }
    }
  }
  glDisable(GL_PROGRAM_POINT_SIZE);
  glBindVertexArray(0);
}

}  // namespace strandcast
