#include "apps/field_slices.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "apps/output_folder.h"

namespace strandcast {
namespace {

constexpr int kLongSide = 900;  // pixels

/// Colour of a signed distance, m. `pixel`: size of a pixel, m. `line`: distance between thin lines, m.
std::array<double, 3> colour(double distance, double pixel, double line, double band) {
  if (std::fabs(distance) < pixel) return {0, 0, 0};
  constexpr std::array<double, 3> kOutside{0.13, 0.40, 0.67}, kInside{0.70, 0.09, 0.17};
  const std::array<double, 3>& full = distance > 0 ? kOutside : kInside;
  const double strength = 0.15 + 0.85 * std::min(1.0, std::fabs(distance) / (2 * band));
  const double to_line = std::fabs(std::remainder(distance, line));
  const double shade = to_line < 0.5 * pixel && std::fabs(distance) < 2 * band ? 0.8 : 1.0;
  std::array<double, 3> out{};
  for (int c = 0; c < 3; ++c) out[c] = shade * (1 + strength * (full[c] - 1));
  return out;
}

}  // namespace

Image fieldSlice(const DistanceField& field, int axis, double part) {
  const FieldGrid& grid = field.grid;
  // Axes to the right and upwards in the picture: views from the front, from above and from the side.
  const int right = axis == 0 ? 2 : 0, up = axis == 1 ? 2 : 1;
  std::array<double, 3> size{};
  for (int a = 0; a < 3; ++a) size[a] = double{grid.cell} * kBrickCells * grid.bricks[a];
  const double pixel = std::max(size[right], size[up]) / kLongSide;
  Image image;
  image.width = std::max(1, static_cast<int>(std::lround(size[right] / pixel)));
  image.height = std::max(1, static_cast<int>(std::lround(size[up] / pixel)));
  image.rgb.reserve(size_t{3} * image.width * image.height);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      Vec3 p;
      p[axis] = static_cast<float>(grid.origin[axis] + part * size[axis]);
      p[right] = static_cast<float>(grid.origin[right] + (x + 0.5) * pixel);
      p[up] = static_cast<float>(grid.origin[up] + size[up] - (y + 0.5) * pixel);
      for (const double c : colour(field.at(p).distance, pixel, 4.0 * grid.cell, grid.band))
        image.rgb.push_back(static_cast<uint8_t>(std::lround(255 * std::clamp(c, 0.0, 1.0))));
    }
  return image;
}

std::vector<std::filesystem::path> writeFieldSlices(const DistanceField& field,
                                                    const std::filesystem::path& folder) {
  const OutputFolder made(folder);
  std::vector<std::filesystem::path> files;
  for (int axis = 0; axis < 3; ++axis)
    for (const int percent : {25, 50, 75}) {
      files.push_back(folder / fmt::format("{}_{}.png", "xyz"[axis], percent));
      writePng(files.back(), fieldSlice(field, axis, percent / 100.0));
    }
  return files;
}

}  // namespace strandcast
