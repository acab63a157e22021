#pragma once
#include <epoxy/gl.h>

#include <utility>

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

}  // namespace strandcast
