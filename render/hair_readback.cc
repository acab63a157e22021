#include "render/hair_readback.h"

#include <algorithm>

#include "render/framebuffer.h"

namespace strandcast {

std::vector<GrownVertex> readComputed(const HairPass& pass, const GuideNodes& nodes, int node_stride) {
  const HairVertices& grown = pass.vertices();
  const size_t per_hair = static_cast<size_t>(grown.nodesPerHair());
  std::vector<GrownVertex> read;
  std::vector<float> numbers;
  for (const HairVertices::Chunk& chunk : grown.chunks()) {
    if (chunk.first >= grown.hairs()) break;
    numbers.resize(std::min(chunk.hairs, grown.hairs() - chunk.first) * per_hair * 8);
    glGetNamedBufferSubData(chunk.vertices.id(), 0, static_cast<GLsizeiptr>(numbers.size() * sizeof(float)),
                            numbers.data());
    for (size_t v = 0; v < numbers.size() / 8; ++v) {
      const float* n = &numbers[8 * v];
      const int node = static_cast<int>(v % per_hair) * node_stride;
      read.push_back({Vec3(n[0], n[1], n[2]), static_cast<uint32_t>(chunk.first + v / per_hair),
                      Vec3(n[4], n[5], n[6]), static_cast<uint32_t>(std::min(node, nodes.segments()))});
    }
  }
  return read;
}

std::vector<GrownVertex> readTessellated(const HairPass& pass, const GuideNodes& nodes,
                                         const HairDetail& detail) {
  const size_t segments =
      static_cast<size_t>((nodes.segments() + detail.node_stride - 1) / detail.node_stride);
  const gl::Program program("hair read back", tessellatedStages("#define CAPTURE\n", nullptr));
  const gl::Buffer target(detail.hairs * segments * 2 * sizeof(float[8]), nullptr, GL_DYNAMIC_STORAGE_BIT);
  GLuint query = 0;
  glGenQueries(1, &query);
  // OpenGL requires a framebuffer even where nothing is rasterised.
  const Texture nowhere(GL_RGBA8, 16, 16, GL_NEAREST);
  const Framebuffer framebuffer(&nowhere, nullptr);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.id());
  glEnable(GL_RASTERIZER_DISCARD);
  pass.bind(program, nodes, detail);
  glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, target.id());
  glBeginQuery(GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN, query);
  glBeginTransformFeedback(GL_LINES);
  pass.drawPatches(nodes, detail);
  glEndTransformFeedback();
  glEndQuery(GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN);
  glDisable(GL_RASTERIZER_DISCARD);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  GLuint lines = 0;
  glGetQueryObjectuiv(query, GL_QUERY_RESULT, &lines);
  glDeleteQueries(1, &query);
  std::vector<float> numbers(static_cast<size_t>(lines) * 2 * 8);
  glGetNamedBufferSubData(target.id(), 0, static_cast<GLsizeiptr>(numbers.size() * sizeof(float)),
                          numbers.data());
  std::vector<GrownVertex> read;
  for (size_t v = 0; v < numbers.size(); v += 8) {
    const float* n = &numbers[v];
    read.push_back({Vec3(n[0], n[1], n[2]), static_cast<uint32_t>(n[3]), Vec3(n[4], n[5], n[6]),
                    static_cast<uint32_t>(n[7])});
  }
  return read;
}

}  // namespace strandcast
