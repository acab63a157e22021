#include "render/picture_geometry.h"

#include <algorithm>
#include <cmath>

#include "core/srgb.h"
#include "kernels/scalar_picture.h"
#include "render/hair_pass.h"
#include "render/render_settings.h"

namespace strandcast {
namespace {

/// The hair's own colour, linear; else `common`.
Vec3 ownColorOr(const Hair& hair, const Vec3& common) {
  if (hair.color == 0) return common;
  Vec3 color;
  for (int c = 0; c < 3; ++c) color[c] = linearOf(static_cast<float>(hair.color >> (8 * c) & 255u) / 255);
  return color;
}

Vec3 tintOf(const Hair& hair, const Vec3& color, float along) {
  const kernels::f32::real3 tint =
      kernels::f32::hairTint({color.x(), color.y(), color.z()}, hair.shade, hair.warmth, along);
  return {tint.x, tint.y, tint.z};
}

void addGrownVertices(const HairPass& pass, const HairVertices& grown, const RenderSettings& settings,
                      PictureGeometry& geometry) {
  const auto per_hair = static_cast<size_t>(grown.nodesPerHair());
  std::vector<float> numbers;
  for (const HairVertices::Chunk& chunk : grown.chunks()) {
    if (chunk.first >= grown.hairs()) break;
    const size_t hairs = std::min(chunk.hairs, grown.hairs() - chunk.first);
    numbers.resize(hairs * per_hair * 8);
    glGetNamedBufferSubData(chunk.vertices.id(), 0, static_cast<GLsizeiptr>(numbers.size() * sizeof(float)),
                            numbers.data());
    for (size_t h = 0; h < hairs; ++h) {
      const float* first = &numbers[h * per_hair * 8];
      const bool is_sound =
          std::all_of(first, first + per_hair * 8, [](float n) { return std::isfinite(n); });
      if (!is_sound || first[7] < 0) continue;
      const Hair& hair = pass.hairs()[pass.listed(grown.first() + chunk.first + h)];
      const float width = settings.hair_width * hair.width;
      const size_t begin = geometry.positions.size();
      for (size_t v = 0; v < per_hair; ++v) {
        const float* n = first + 8 * v;
        const Vec3 position(n[0], n[1], n[2]);
        if (geometry.positions.size() > begin && position == geometry.positions.back()) continue;
        geometry.positions.push_back(position);
        geometry.tangents.emplace_back(n[4], n[5], n[6]);
        geometry.widths.push_back(width * std::max(n[7], kTipWidth));
      }
      if (geometry.positions.size() < begin + 2 || !(width > 0)) {
        geometry.positions.resize(begin);
        geometry.tangents.resize(begin);
        geometry.widths.resize(begin);
        continue;
      }
      geometry.offsets.push_back(static_cast<uint32_t>(geometry.positions.size()));
      const Vec3 color = ownColorOr(hair, settings.hair_color);
      geometry.colors.push_back({tintOf(hair, color, 0), tintOf(hair, color, 1)});
    }
  }
}

}  // namespace

void addGrownHair(const HairPass& pass, const RenderSettings& settings, PictureGeometry& geometry) {
  addGrownVertices(pass, pass.vertices(), settings, geometry);
  addGrownVertices(pass, pass.boundVertices(), settings, geometry);
}

}  // namespace strandcast
