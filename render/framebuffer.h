#pragma once
#include <epoxy/gl.h>

#include <utility>

namespace strandcast {

/// A texture of one level; needs a current context for its whole life.
class Texture {
 public:
  Texture() = default;
  /// An array of so many where `slices` is more than 0.
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

/// A framebuffer over textures, any of which may be null. Throws Error when the device refuses it.
class Framebuffer {
 public:
  Framebuffer() = default;
  Framebuffer(const Texture* color, const Texture* depth);
  /// Over `count` slices of an array from `first` on, a colour each.
  static Framebuffer ofColors(const Texture& slices, int first, int count);
  /// Over one slice of an array of depths.
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

/// Where pictures are drawn: multisampled sRGB colour and depth, and the resolved picture.
class PictureBuffer {
 public:
  /// `samples` becomes what the device has, fewer or more (llvmpipe: 4 for 2); samples() says what it became.
  PictureBuffer(int width, int height, int samples);
  ~PictureBuffer();
  PictureBuffer(const PictureBuffer&) = delete;
  PictureBuffer& operator=(const PictureBuffer&) = delete;

  int samples() const { return samples_; }
  void clear() const;  ///< depth to the far end, colour to black
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
