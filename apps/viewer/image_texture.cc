#include "apps/viewer/image_texture.h"

#include <epoxy/gl.h>
#include <imgui/imgui.h>

namespace strandcast {

ImageTexture::~ImageTexture() {
  if (id_ != 0) glDeleteTextures(1, &id_);
}

void ImageTexture::set(const Image& image) {
  if (image.width != width_ || image.height != height_) {
    if (id_ != 0) glDeleteTextures(1, &id_);
    glCreateTextures(GL_TEXTURE_2D, 1, &id_);
    glTextureStorage2D(id_, 1, GL_RGB8, image.width, image.height);
    glTextureParameteri(id_, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    width_ = image.width;
    height_ = image.height;
  }
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTextureSubImage2D(id_, 0, 0, 0, width_, height_, GL_RGB, GL_UNSIGNED_BYTE, image.rgb.data());
}

void ImageTexture::show(float width) const {
  const float height = width * static_cast<float>(height_) / static_cast<float>(width_);
  ImGui::Image(reinterpret_cast<ImTextureID>(static_cast<uintptr_t>(id_)), {width, height});
}

}  // namespace strandcast
