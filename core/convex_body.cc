#include "core/convex_body.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"

namespace strandcast {
namespace {

constexpr size_t kMostPlanes = 1024;  // each contact query tests all of them

}  // namespace

ConvexBody convexBody(const TriangleMesh& mesh, float tolerance) {
  const std::string name = mesh.name.empty() ? "mesh" : "mesh " + mesh.name;
  for (size_t v = 0; v < mesh.positions.size(); ++v)
    if (!mesh.positions[v].allFinite())
      throw Error("a vertex is not finite", fmt::format("{}, vertex {}", name, v), "repair the mesh");
  ConvexBody body;
  body.bounds = mesh.bounds();
  const float near = tolerance * body.bounds.diagonal().norm();
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Vec3& p : mesh.positions)
    middle += p.cast<double>() / static_cast<double>(mesh.positions.size());
  Eigen::Vector3d open = Eigen::Vector3d::Zero();  // sum of area vectors: zero for a closed surface
  double area = 0;
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    std::array<Eigen::Vector3d, 3> corner;
    for (int c = 0; c < 3; ++c) corner[c] = mesh.positions[mesh.triangles[t][c]].cast<double>();
    Eigen::Vector3d normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
    const double size = normal.norm();
    if (!(size > 0)) continue;
    normal /= normal.dot(corner[0] - middle) < 0 ? -size : size;
    open += size * normal;
    area += size;
    const double distance = normal.dot(corner[0]);
    const auto same = [&](const std::array<float, 4>& plane) {
      return (Eigen::Vector3d(plane[0], plane[1], plane[2]) - normal).norm() < tolerance &&
             std::fabs(plane[3] - distance) < near;
    };
    if (std::any_of(body.planes.begin(), body.planes.end(), same)) continue;
    for (const Vec3& p : mesh.positions) {
      const double before = normal.dot(p.cast<double>()) - distance;
      if (before > near)
        throw Error(
            fmt::format("the mesh is not convex: a vertex lies {:.3g} m outside a triangle's plane", before),
            fmt::format("{}, triangle {}", name, t), "bake a distance field of it instead");
    }
    if (body.planes.size() == kMostPlanes)
      throw Error(fmt::format("the convex body has more than {} planes", kMostPlanes), name,
                  "bake a distance field of it instead");
    const Eigen::Vector3f n = normal.cast<float>();
    body.planes.push_back({n.x(), n.y(), n.z(), static_cast<float>(distance)});
  }
  const auto before_middle = [&](const std::array<float, 4>& plane) {
    return Eigen::Vector3d(plane[0], plane[1], plane[2]).dot(middle) - plane[3] > -near;
  };
  if (body.planes.size() < 4 || std::any_of(body.planes.begin(), body.planes.end(), before_middle))
    throw Error("the mesh has no volume", name, "give a closed convex mesh");
  if (open.norm() > 1e-3 * area) throw Error("the mesh is open", name, "give a closed convex mesh");
  return body;
}

}  // namespace strandcast
