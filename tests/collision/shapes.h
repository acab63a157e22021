#pragma once
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <random>

#include "core/geometry.h"

namespace strandcast::shapes {

/// An icosphere about `centre`: 20 * 4^levels triangles, closed, wound outward.
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

/// An icosphere with a wavy surface: closed, not convex.
inline TriangleMesh potato(float radius, int levels) {
  TriangleMesh mesh = sphere(radius, levels);
  for (Vec3& p : mesh.positions) {
    const Vec3 q = p / radius;
    p *= 1 + 0.25f * std::sin(4 * q.x()) * std::cos(3 * q.y()) + 0.15f * std::sin(5 * q.z() + 1);
  }
  mesh.name = "potato";
  return mesh;
}

/// A sphere stretched along y: its axis extends from -half to half.
inline TriangleMesh capsule(float radius, float half, int levels) {
  TriangleMesh mesh = sphere(radius, levels);
  for (Vec3& p : mesh.positions) p.y() += p.y() < 0 ? -half : half;
  mesh.name = "capsule";
  return mesh;
}

/// Twelve triangles about the origin, wound outward.
inline TriangleMesh box(const Vec3& half) {
  TriangleMesh mesh;
  mesh.name = "box";
  for (int c = 0; c < 8; ++c)
    mesh.positions.emplace_back(c & 1 ? half.x() : -half.x(), c & 2 ? half.y() : -half.y(),
                                c & 4 ? half.z() : -half.z());
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

/// A sphere of `rings` times `sectors` quads, each split in two. Fast to make with millions of triangles.
inline TriangleMesh globe(float radius, uint32_t rings, uint32_t sectors) {
  TriangleMesh mesh;
  mesh.name = "globe";
  for (uint32_t r = 0; r <= rings; ++r)
    for (uint32_t s = 0; s < sectors; ++s) {
      const double down = std::numbers::pi * r / rings, round = 2 * std::numbers::pi * s / sectors;
      mesh.positions.push_back(Eigen::Vector3d(radius * std::sin(down) * std::cos(round),
                                               radius * std::cos(down),
                                               radius * std::sin(down) * std::sin(round))
                                   .cast<float>());
    }
  for (uint32_t r = 0; r < rings; ++r)
    for (uint32_t s = 0; s < sectors; ++s) {
      const uint32_t a = r * sectors + s, b = r * sectors + (s + 1) % sectors;
      mesh.triangles.push_back({a, b, b + sectors});
      mesh.triangles.push_back({a, b + sectors, a + sectors});
    }
  return mesh;
}

/// Both meshes in one, not connected.
inline TriangleMesh together(TriangleMesh a, const TriangleMesh& b) {
  const auto first = static_cast<uint32_t>(a.positions.size());
  a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
  for (const auto& t : b.triangles) a.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  return a;
}

inline Vec3 randomPoint(std::mt19937& random, float reach) {
  std::uniform_real_distribution<float> uniform(-reach, reach);
  const float x = uniform(random), y = uniform(random), z = uniform(random);
  return {x, y, z};
}

}  // namespace strandcast::shapes

namespace strandcast {

inline void writeObj(const std::filesystem::path& file, const TriangleMesh& mesh) {
  std::ofstream out(file);
  for (const Vec3& p : mesh.positions) out << "v " << p.x() << ' ' << p.y() << ' ' << p.z() << '\n';
  for (const auto& t : mesh.triangles) out << "f " << t[0] + 1 << ' ' << t[1] + 1 << ' ' << t[2] + 1 << '\n';
}

}  // namespace strandcast
