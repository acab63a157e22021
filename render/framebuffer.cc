#include "render/framebuffer.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/error.h"
#include "render/shaders.h"

namespace strandcast {
namespace {

void requireComplete(GLuint framebuffer, const char* name) {
  const GLenum status = glCheckNamedFramebufferStatus(framebuffer, GL_FRAMEBUFFER);
  if (status != GL_FRAMEBUFFER_COMPLETE)
    throw Error("the OpenGL device refuses a framebuffer",
                std::string(name) + ", status " + std::to_string(status),
                "try a smaller picture or fewer samples");
}

}  // namespace

Texture::Texture(GLenum format, int width, int height, GLenum filter, int slices) {
  glCreateTextures(slices > 0 ? GL_TEXTURE_2D_ARRAY : GL_TEXTURE_2D, 1, &id_);
  if (slices > 0)
    glTextureStorage3D(id_, 1, format, width, height, slices);
  else
    glTextureStorage2D(id_, 1, format, width, height);
  glTextureParameteri(id_, GL_TEXTURE_MIN_FILTER, static_cast<GLint>(filter));
  glTextureParameteri(id_, GL_TEXTURE_MAG_FILTER, static_cast<GLint>(filter));
  glTextureParameteri(id_, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER);
  glTextureParameteri(id_, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER);
}

Framebuffer::Framebuffer(const Texture* color, const Texture* depth) {
  glCreateFramebuffers(1, &id_);
  if (color != nullptr) glNamedFramebufferTexture(id_, GL_COLOR_ATTACHMENT0, color->id(), 0);
  if (depth != nullptr) glNamedFramebufferTexture(id_, GL_DEPTH_ATTACHMENT, depth->id(), 0);
  const GLenum target = color != nullptr ? GL_COLOR_ATTACHMENT0 : GL_NONE;
  glNamedFramebufferDrawBuffer(id_, target);
  glNamedFramebufferReadBuffer(id_, target);
  requireComplete(id_, "off-screen target");
}

Framebuffer Framebuffer::ofColors(const Texture& slices, int first, int count) {
  Framebuffer made;
  glCreateFramebuffers(1, &made.id_);
  std::vector<GLenum> targets;
  for (int slice = 0; slice < count; ++slice) {
    targets.push_back(GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(slice));
    glNamedFramebufferTextureLayer(made.id_, targets.back(), slices.id(), 0, first + slice);
  }
  glNamedFramebufferDrawBuffers(made.id_, count, targets.data());
  requireComplete(made.id_, "off-screen slices");
  return made;
}

Framebuffer Framebuffer::ofDepth(const Texture& slices, int slice) {
  Framebuffer made;
  glCreateFramebuffers(1, &made.id_);
  glNamedFramebufferTextureLayer(made.id_, GL_DEPTH_ATTACHMENT, slices.id(), 0, slice);
  glNamedFramebufferDrawBuffer(made.id_, GL_NONE);
  glNamedFramebufferReadBuffer(made.id_, GL_NONE);
  requireComplete(made.id_, "off-screen slice of depth");
  return made;
}

PictureBuffer::PictureBuffer(int width, int height, int samples) : width_(width), height_(height) {
  GLint most = 1, largest = 0;
  glGetIntegerv(GL_MAX_SAMPLES, &most);
  glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &largest);
  if (width > largest || height > largest)
    throw Error("a picture is too large for the OpenGL device",
                std::to_string(width) + " x " + std::to_string(height),
                "at most " + std::to_string(largest) + " pixels a side");
  const int wanted = std::clamp(samples, 1, std::max(most, 1));
  glCreateRenderbuffers(2, renderbuffers_);
  glNamedRenderbufferStorageMultisample(renderbuffers_[0], wanted > 1 ? wanted : 0, GL_SRGB8_ALPHA8, width,
                                        height);
  GLint given = 0;
  glGetNamedRenderbufferParameteriv(renderbuffers_[0], GL_RENDERBUFFER_SAMPLES, &given);
  samples_ = std::max(given, 1);
  glNamedRenderbufferStorageMultisample(renderbuffers_[1], given, GL_DEPTH_COMPONENT24, width, height);
  glCreateFramebuffers(1, &drawing_);
  glNamedFramebufferRenderbuffer(drawing_, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, renderbuffers_[0]);
  glNamedFramebufferRenderbuffer(drawing_, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, renderbuffers_[1]);
  requireComplete(drawing_, "multisampled picture");
  picture_ = Texture(GL_SRGB8_ALPHA8, width, height, GL_LINEAR);
  resolved_ = Framebuffer(&picture_, nullptr);
}

PictureBuffer::~PictureBuffer() {
  glDeleteFramebuffers(1, &drawing_);
  glDeleteRenderbuffers(2, renderbuffers_);
}

void PictureBuffer::clear() const {
  const float black[4] = {0, 0, 0, 1}, far_depth = 1;
  glClearNamedFramebufferfv(drawing_, GL_COLOR, 0, black);
  glClearNamedFramebufferfv(drawing_, GL_DEPTH, 0, &far_depth);
}

void PictureBuffer::bindForDrawing() const {
  glBindFramebuffer(GL_FRAMEBUFFER, drawing_);
  glViewport(0, 0, width_, height_);
}

void PictureBuffer::resolve() const {
  glBlitNamedFramebuffer(drawing_, resolved_.id(), 0, 0, width_, height_, 0, 0, width_, height_,
                         GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

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
