// Pictures of floating-point channels in OpenEXR files.
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace strandcast {

/// A picture of named channels, all of its size: "R", "G", "B", "Z", "single.R" and so on.
struct FloatImage {
  struct Channel {
    std::string name;
    std::vector<float> values;  ///< width x height, top row first
  };
  int width = 0, height = 0;
  std::vector<Channel> channels;
  std::map<std::string, std::string> attributes;  ///< texts in the file's header

  /// The values of a channel; null where there is none of that name.
  const std::vector<float>* find(const std::string& name) const;
};

/// Writes 32-bit floats, compressed without loss (ZIP). An existing file stays until the new one is complete.
/// Equal pictures give equal bytes. Throws Error where the file cannot be written or a channel has a wrong
/// size.
void writeExr(const std::filesystem::path& file, const FloatImage& image);

/// Reads the first part: its data window, all channels without subsampling, as floats. Throws Error where the
/// file cannot be read, is no OpenEXR file, is damaged, holds deep data, or has more than 2^28 pixels.
FloatImage readExr(const std::filesystem::path& file);

}  // namespace strandcast
