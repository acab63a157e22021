#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

namespace strandcast {

/// A picture in main memory.
struct Image {
  int width = 0, height = 0;
  std::vector<uint8_t> rgb;  ///< sRGB, 3 bytes per pixel, top row first
};

/// Both throw Error where the file cannot be written or read, or is not a valid PNG.
void writePng(const std::filesystem::path& file, const Image& image);
Image readPng(const std::filesystem::path& file);

}  // namespace strandcast
