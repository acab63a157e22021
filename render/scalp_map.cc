#include "render/scalp_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "io/image.h"

namespace strandcast {

float ScalpMap::at(const Vec2& place) const {
  const float x = (place.x() - std::floor(place.x())) * static_cast<float>(width) - 0.5f;
  const float y =
      std::clamp(place.y() * static_cast<float>(height) - 0.5f, 0.0f, static_cast<float>(height - 1));
  const int left = static_cast<int>(std::floor(x)), top = std::min(static_cast<int>(y), height - 1);
  const float right_part = x - static_cast<float>(left), bottom_part = y - static_cast<float>(top);
  const auto value = [&](int i, int j) {
    return values[static_cast<size_t>(std::min(j, height - 1)) * width + (i + width) % width];
  };
  const auto row = [&](int j) { return std::lerp(value(left, j), value(left + 1, j), right_part); };
  return std::lerp(row(top), row(top + 1), bottom_part);
}

ScalpMap readScalpMap(const std::filesystem::path& file) {
  const Image image = readPng(file);
  ScalpMap map{image.width, image.height, {}};
  map.values.reserve(image.rgb.size() / 3);
  for (size_t i = 0; i < image.rgb.size(); i += 3)
    map.values.push_back(static_cast<float>(image.rgb[i] + image.rgb[i + 1] + image.rgb[i + 2]) / 765.0f);
  return map;
}

ScalpPlaces::ScalpPlaces(const StrandSet& guides) : guides_(guides) {
  Box roots;
  for (size_t g = 0; g < guides.strands(); ++g)
    if (guides.verticesOf(g) > 0 && guides.strand(g).front().allFinite())
      roots.extend(Eigen::Vector3f(guides.strand(g).front()));
  if (!roots.isEmpty()) middle_ = roots.center();
}

Vec2 ScalpPlaces::of(const uint32_t (&guides)[3], const float (&weights)[2]) const {
  if (guides_.uvs.size() == guides_.strands()) {
    const Vec2& first = guides_.uvs[guides[0]];
    Vec2 place = first;
    for (int k = 0; k < 2; ++k) place += weights[k] * (guides_.uvs[guides[k + 1]] - first);
    return place;
  }
  const Vec3& first = guides_.strand(guides[0]).front();
  Vec3 out = first - middle_;
  for (int k = 0; k < 2; ++k) out += weights[k] * (guides_.strand(guides[k + 1]).front() - first);
  const float turn = std::atan2(out.x(), out.z()) / (2 * std::numbers::pi_v<float>);
  const float height = out.y() / std::max(out.norm(), 1e-9f);
  return {0.5f + turn, 0.5f - std::asin(std::clamp(height, -1.0f, 1.0f)) / std::numbers::pi_v<float>};
}

}  // namespace strandcast
