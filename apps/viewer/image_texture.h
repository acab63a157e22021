#pragma once
#include "io/image.h"

namespace strandcast {

/// An image as a texture that a panel can show. Needs a current OpenGL context for its whole life.
class ImageTexture {
 public:
  ImageTexture() = default;
  ~ImageTexture();
  ImageTexture(const ImageTexture&) = delete;
  ImageTexture& operator=(const ImageTexture&) = delete;

  /// Uploads an image.
  void set(const Image& image);
  bool isEmpty() const { return id_ == 0; }
  /// Draws the image `width` pixels wide into the current panel.
  void show(float width) const;

 private:
  unsigned id_ = 0;
  int width_ = 0, height_ = 0;
};

}  // namespace strandcast
