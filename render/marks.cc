#include "render/marks.h"

#include <algorithm>

#include "render/shaders.h"

namespace strandcast {
namespace {

constexpr float kTangentLength = 0.01f, kPointPixels = 5, kInsidePixels = 3;
constexpr float kInsideSlack = 1e-5f;  // m, tolerance for rounding

gl::Program program(const char* name, const char* defines) {
  return {name,
          {{GL_VERTEX_SHADER, shaders::kMarksVert, defines}, {GL_FRAGMENT_SHADER, shaders::kMarksFrag}}};
}

}  // namespace

Marks::Marks()
    : guides_(program("guides", "#define GUIDES\n")),
      tangents_(program("tangents", "#define TANGENTS\n")),
      collided_(program("collided vertices", "#define COLLIDED\n")),
      inside_(program("vertices inside", "#define INSIDE\n")) {
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
    const HairVertices& grown = hair.vertices();
    inside_.set("size", kInsidePixels);
    inside_.set("reach", kInsideSlack);
    inside_.set("nodes_per_hair", static_cast<unsigned>(grown.nodesPerHair()));
    inside_.use();
    for (const HairVertices::Chunk& chunk : grown.chunks()) {
      if (chunk.first >= grown.hairs()) break;
      chunk.vertices.bindStorage(binding::kHairVertices);
      inside_.set("first_hair", static_cast<unsigned>(chunk.first));
      glDrawArraysInstanced(GL_POINTS, 0, grown.nodesPerHair(),
                            static_cast<GLsizei>(std::min(chunk.hairs, grown.hairs() - chunk.first)));
    }
  }
  glDisable(GL_PROGRAM_POINT_SIZE);
  glBindVertexArray(0);
}

}  // namespace strandcast
