#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

namespace strandcast {

struct Image {
  int width = 0, height = 0;
  std::vector<uint8_t> rgb;  ///< sRGB, 3 bytes a pixel, top row first
};

/// Both throw Error when the file cannot be written or read, or is not what it should be.
void writePng(const std::filesystem::path& file, const Image& image);
Image readPng(const std::filesystem::path& file);

}  // namespace strandcast
