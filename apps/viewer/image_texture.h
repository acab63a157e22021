#pragma once
#include "render/image.h"

namespace strandcast {

/// A picture that a panel can show; needs a current context for its whole life.
class ImageTexture {
 public:
  ImageTexture() = default;
  ~ImageTexture();
  ImageTexture(const ImageTexture&) = delete;
  ImageTexture& operator=(const ImageTexture&) = delete;

  void set(const Image& image);
  bool isEmpty() const { return id_ == 0; }
  /// As wide as is given, in the panel that is being made.
  void show(float width) const;

 private:
  unsigned id_ = 0;
  int width_ = 0, height_ = 0;
};

}  // namespace strandcast
