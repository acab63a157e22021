#include "io/image.h"

#include <png.h>

#include "core/error.h"

namespace strandcast {
namespace {

constexpr int kMaxSide = 32768;

bool sizeFits(const Image& image) {
  return image.width > 0 && image.height > 0 && image.width <= kMaxSide && image.height <= kMaxSide &&
         image.rgb.size() == static_cast<size_t>(image.width) * image.height * 3;
}

}  // namespace

// libpng's simplified interface returns errors; it neither aborts nor longjmps.
void writePng(const std::filesystem::path& file, const Image& image) {
  if (!sizeFits(image))
    throw Error("a picture cannot be written",
                file.string() + ": " + std::to_string(image.width) + " x " + std::to_string(image.height) +
                    " with " + std::to_string(image.rgb.size()) + " bytes",
                "a picture has 1 to 32768 pixels a side and 3 bytes a pixel");
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGB;
  png.flags = PNG_IMAGE_FLAG_FAST;
  const int ok = png_image_write_to_file(&png, file.c_str(), 0, image.rgb.data(), 0, nullptr);
  const std::string message = png.message;
  png_image_free(&png);
  if (ok == 0)
    throw Error("a picture cannot be written", file.string() + ": " + message,
                "check the folder and the disk");
}

Image readPng(const std::filesystem::path& file) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  Image image;
  bool ok = png_image_begin_read_from_file(&png, file.c_str()) != 0;
  if (ok && (png.width > kMaxSide || png.height > kMaxSide)) {
    png_image_free(&png);
    throw Error("a picture is too large", file.string(), "at most 32768 pixels a side");
  }
  if (ok) {
    png.format = PNG_FORMAT_RGB;
    image.width = static_cast<int>(png.width);
    image.height = static_cast<int>(png.height);
    image.rgb.resize(PNG_IMAGE_SIZE(png));
    ok = png_image_finish_read(&png, nullptr, image.rgb.data(), 0, nullptr) != 0;
  }
  const std::string message = png.message;
  png_image_free(&png);
  if (!ok) throw Error("a picture cannot be read", file.string() + ": " + message, "it must be a PNG file");
  return image;
}

}  // namespace strandcast
