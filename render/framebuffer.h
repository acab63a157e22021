// Render targets, and the filter that reduces a supersampled picture.
#pragma once
#include <epoxy/gl.h>

#include <utility>

#include "gl/program.h"

namespace strandcast {

/// A texture with one mip level; needs a current context for its whole life.
class Texture {
 public:
  Texture() = default;
  /// `slices` above 0: an array texture of that many.
  Texture(GLenum format, int width, int height, GLenum filter, int slices = 0);
  ~Texture() {
    if (id_ != 0) glDeleteTextures(1, &id_);
  }
  Texture(Texture&& other) noexcept { *this = std::move(other); }
  Texture& operator=(Texture&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }
  GLuint id() const { return id_; }

 private:
  GLuint id_ = 0;
};

/// A framebuffer over textures, any of which may be null. Throws Error where the device rejects it.
class Framebuffer {
 public:
  Framebuffer() = default;
  Framebuffer(const Texture* color, const Texture* depth);
  /// Attaches `count` slices of an array from `first` as colours, one each.
  static Framebuffer ofColors(const Texture& slices, int first, int count);
  /// Attaches one slice of a depth array.
  static Framebuffer ofDepth(const Texture& slices, int slice);
  ~Framebuffer() {
    if (id_ != 0) glDeleteFramebuffers(1, &id_);
  }
  Framebuffer(Framebuffer&& other) noexcept { *this = std::move(other); }
  Framebuffer& operator=(Framebuffer&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }
  GLuint id() const { return id_; }

 private:
  GLuint id_ = 0;
};

/// The render target of pictures: multisampled sRGB colour and depth, and the resolved picture.
class PictureBuffer {
 public:
  /// `samples`: the device may round it up or down (llvmpipe: 4 for 2); samples() returns the actual number.
  PictureBuffer(int width, int height, int samples);
  ~PictureBuffer();
  PictureBuffer(const PictureBuffer&) = delete;
  PictureBuffer& operator=(const PictureBuffer&) = delete;

  int samples() const { return samples_; }
  void clear() const;  ///< depth to the far plane, colour to black
  void bindForDrawing() const;
  void resolve() const;
  GLuint resolvedFramebuffer() const { return resolved_.id(); }
  GLuint resolvedTexture() const { return picture_.id(); }

 private:
  int width_, height_, samples_;
  GLuint renderbuffers_[2] = {0, 0};  // colour, depth
  GLuint drawing_ = 0;
  Texture picture_;
  Framebuffer resolved_;
};

/// Filter weights around a pixel's centre, in output pixels. kBox: one pixel. kTent: two pixels. kGaussian:
/// standard deviation 0.5, cut at 1.5. kMitchell: the cubic of Mitchell and Netravali (1988) with B = C =
/// 1/3, which reaches 2 and is the sharpest.
enum class PixelFilter { kBox, kTent, kGaussian, kMitchell };

/// Reduces a picture that is `factor` times as large per side, in linear light.
class Supersampling {
 public:
  /// `width`, `height`: of the output, pixels. `factor`: 2 to 4. Throws Error.
  Supersampling(int width, int height, int factor, PixelFilter filter);
  ~Supersampling();
  Supersampling(const Supersampling&) = delete;
  Supersampling& operator=(const Supersampling&) = delete;

  /// Filters the texture `large` into texture().
  void draw(GLuint large) const;
  const Texture& texture() const { return texture_; }
  const Framebuffer& framebuffer() const { return target_; }

 private:
  int width_, height_;
  gl::Program program_;
  Texture texture_;
  Framebuffer target_;
  GLuint empty_vertices_ = 0;
};

/// The weight of a sample `x` pixels from the centre along one axis; not normalised.
float filterWeight(PixelFilter filter, float x);
/// Radius of the filter, pixels.
float filterReach(PixelFilter filter);

}  // namespace strandcast
