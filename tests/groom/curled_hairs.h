// Curled hairs of a few vertices each, of which no two are alike.
#pragma once
#include <cmath>
#include <random>
#include <vector>

#include "core/strand_set.h"

namespace strandcast {

/// Curled hairs of 2 to 30 vertices with roots on a patch of 6 cm, `height` m above the origin.
/// Deterministic.
inline StrandSet curledHairs(size_t hairs, uint32_t seed, float height) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(-1, 1);
  StrandSet strands;
  for (size_t s = 0; s < hairs; ++s) {
    const Vec3 root(0.03f * unit(random), height, 0.03f * unit(random));
    const float phase = 3 * unit(random), radius = 0.01f + 0.005f * unit(random);
    std::vector<Vec3> points;
    const size_t vertices = 2 + s % 29;
    for (size_t i = 0; i < vertices; ++i) {
      const float t = static_cast<float>(i) / static_cast<float>(vertices - 1), turn = 9 * t + phase;
      points.push_back(root + Vec3(radius * (std::cos(turn) - std::cos(phase)), -0.2f * t,
                                   radius * (std::sin(turn) - std::sin(phase))));
    }
    strands.append(points);
  }
  return strands;
}

}  // namespace strandcast
