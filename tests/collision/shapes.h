#pragma once
#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "core/triangle_mesh.h"

namespace strandcast::shapes {

/// An icosphere about `centre`: 20 * 4^levels triangles, closed, outward.
inline TriangleMesh sphere(float radius, int levels, const Vec3& centre = Vec3::Zero()) {
  TriangleMesh mesh;
  mesh.name = "sphere";
  const float t = std::numbers::phi_v<float>;
  mesh.positions = {{-1, t, 0},  {1, t, 0},  {-1, -t, 0}, {1, -t, 0}, {0, -1, t},  {0, 1, t},
                    {0, -1, -t}, {0, 1, -t}, {t, 0, -1},  {t, 0, 1},  {-t, 0, -1}, {-t, 0, 1}};
  mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> middles;
    const auto middle = [&](uint32_t a, uint32_t b) {
      const auto [it, added] =
          middles.try_emplace(std::minmax(a, b), static_cast<uint32_t>(mesh.positions.size()));
      if (added) mesh.positions.push_back(0.5f * (mesh.positions[a] + mesh.positions[b]));
      return it->second;
    };
    std::vector<std::array<uint32_t, 3>> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    mesh.triangles = finer;
  }
  for (Vec3& p : mesh.positions) p = centre + radius * p.normalized();
  return mesh;
}

/// The same mesh with its surface pushed in and out: closed, not convex.
inline TriangleMesh potato(float radius, int levels) {
  TriangleMesh mesh = sphere(radius, levels);
  for (Vec3& p : mesh.positions) {
    const Vec3 q = p / radius;
    p *= 1 + 0.25f * std::sin(4 * q.x()) * std::cos(3 * q.y()) + 0.15f * std::sin(5 * q.z() + 1);
  }
  mesh.name = "potato";
  return mesh;
}

inline Vec3 randomPoint(std::mt19937& random, float reach) {
  std::uniform_real_distribution<float> uniform(-reach, reach);
  const float x = uniform(random), y = uniform(random), z = uniform(random);
  return {x, y, z};
}

}  // namespace strandcast::shapes
