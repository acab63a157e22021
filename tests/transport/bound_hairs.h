#pragma once
#include <random>

#include "moving_hair.h"

namespace strandcast {

/// Hairs beside swaying guides, bound at random to up to three of them, with every optional array or with
/// none. Hair h has `vertices(h)` vertices.
template <class VerticesOf>
HairDescription boundHairs(const StrandSet& guides, size_t hairs, VerticesOf vertices, bool with_arrays) {
  std::mt19937 random(17);
  std::uniform_real_distribution<float> unit(-1, 1);
  HairDescription description;
  description.groom_id = 1;
  description.session = 11;
  description.revision = 1;
  std::vector<Vec3> points;
  for (size_t h = 0; h < hairs; ++h) {
    const auto guide = static_cast<uint32_t>(random() % guides.strands());
    const auto other = [&] { return static_cast<uint32_t>(random() % guides.strands()); };
    const auto second = static_cast<uint8_t>(random() % 128), third = static_cast<uint8_t>(random() % 128);
    description.bindings.push_back({{guide, other(), other()}, {second, third}});
    points.resize(vertices(h));
    swayingStrand(guide, 0.1 * unit(random), 0.25f, points);
    const Vec3 beside = 0.01f * Vec3(unit(random), unit(random), unit(random));
    for (Vec3& point : points) point += beside + 0.0005f * Vec3(unit(random), unit(random), unit(random));
    description.hairs.append(points);
    if (!with_arrays) continue;
    for (size_t j = 0; j < points.size(); ++j)
      description.hairs.radii.push_back(40e-6f *
                                            (1 - static_cast<float>(j) / static_cast<float>(points.size())) +
                                        5e-6f * (1 + unit(random)));
    description.hairs.uvs.emplace_back(3 * unit(random), unit(random));
    description.hairs.parts.push_back(static_cast<uint16_t>(random()));
    description.colours.push_back(
        {static_cast<uint8_t>(random()), static_cast<uint8_t>(random()), static_cast<uint8_t>(random())});
    description.ids.push_back(static_cast<uint32_t>(random()));
  }
  return description;
}

inline HairDescription boundHairs(const StrandSet& guides, size_t hairs) {
  return boundHairs(
      guides, hairs, [](size_t) { return 16; }, true);
}

/// Whether `got` is `sent` as a channel hands it out: vertices within `error` (m), the rest alike.
inline bool areAlike(const HairDescription& got, const HairDescription& sent, float error) {
  if (got.hairs.offsets != sent.hairs.offsets || got.hairs.parts != sent.hairs.parts ||
      got.colours != sent.colours || got.ids != sent.ids || got.bindings.size() != sent.bindings.size() ||
      got.hairs.radii.size() != sent.hairs.radii.size() || got.hairs.uvs.size() != sent.hairs.uvs.size())
    return false;
  for (size_t h = 0; h < got.bindings.size(); ++h)
    if (got.bindings[h].guides != sent.bindings[h].guides ||
        got.bindings[h].weights != sent.bindings[h].weights)
      return false;
  for (size_t v = 0; v < got.hairs.vertices(); ++v)
    if (!((got.hairs.positions[v] - sent.hairs.positions[v]).norm() <= error)) return false;
  return true;
}

}  // namespace strandcast
