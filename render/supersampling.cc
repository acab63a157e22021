#include "render/supersampling.h"

#include <cmath>
#include <vector>

#include "render/shaders.h"

namespace strandcast {

float filterReach(PixelFilter filter) {
  switch (filter) {
    case PixelFilter::kBox:
      return 0.5f;
    case PixelFilter::kTent:
      return 1;
    case PixelFilter::kGaussian:
      return 1.5f;
    case PixelFilter::kMitchell:
      break;
  }
  return 2;
}

float filterWeight(PixelFilter filter, float x) {
  const float a = std::fabs(x);
  if (a >= filterReach(filter)) return 0;
  switch (filter) {
    case PixelFilter::kBox:
      return 1;
    case PixelFilter::kTent:
      return 1 - a;
    case PixelFilter::kGaussian:
      return std::exp(-2 * a * a);
    case PixelFilter::kMitchell:
      break;
  }
  return a < 1 ? (21 * a * a * a - 36 * a * a + 16) / 18 : (-7 * a * a * a + 36 * a * a - 60 * a + 32) / 18;
}

Supersampling::Supersampling(int width, int height, int factor, PixelFilter filter)
    : width_(width),
      height_(height),
      program_("supersampling", {{GL_VERTEX_SHADER, shaders::kBackgroundVert},
                                 {GL_FRAGMENT_SHADER, shaders::kSupersamplingFrag}}),
      texture_(GL_SRGB8_ALPHA8, width, height, GL_LINEAR),
      target_(&texture_, nullptr) {
  glCreateVertexArrays(1, &empty_vertices_);
  // Offset of the filter's first sample along an axis; the same for every pixel.
  const int before = static_cast<int>(std::ceil((filterReach(filter) - 0.5f) * static_cast<float>(factor)));
  std::vector<float> weights;
  float sum = 0;
  for (int i = -before; i < factor + before; ++i) {
    const float x = (static_cast<float>(i) + 0.5f) / static_cast<float>(factor) - 0.5f;
    sum += weights.emplace_back(filterWeight(filter, x));
  }
  for (float& weight : weights) weight /= sum;
  program_.set("factor", factor);
  program_.set("before", before);
  program_.set("count", static_cast<int>(weights.size()));
  glProgramUniform1fv(program_.id(), glGetUniformLocation(program_.id(), "weights"),
                      static_cast<GLsizei>(weights.size()), weights.data());
}

Supersampling::~Supersampling() { glDeleteVertexArrays(1, &empty_vertices_); }

void Supersampling::draw(GLuint large) const {
  glBindFramebuffer(GL_FRAMEBUFFER, target_.id());
  glViewport(0, 0, width_, height_);
  glDisable(GL_DEPTH_TEST);
  glBindTextureUnit(0, large);
  program_.use();
  glBindVertexArray(empty_vertices_);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindVertexArray(0);
  glEnable(GL_DEPTH_TEST);
}

}  // namespace strandcast
