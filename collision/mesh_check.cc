#include "collision/mesh_check.h"

#include <algorithm>
#include <numeric>
#include <string>
#include <tuple>

#include "core/error.h"

namespace strandcast {

std::vector<uint32_t> vertexPlaces(const std::vector<Vec3>& positions) {
  std::vector<uint32_t> order(positions.size()), place(positions.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto before = [&](uint32_t i, uint32_t j) {
    const Vec3 &a = positions[i], &b = positions[j];
    return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
  };
  std::sort(order.begin(), order.end(), before);
  for (size_t i = 0; i < order.size(); ++i)
    place[order[i]] =
        i > 0 && !before(order[i - 1], order[i]) ? place[order[i - 1]] : static_cast<uint32_t>(i);
  return place;
}

void requireSoundMesh(const TriangleMesh& mesh) {
  const std::string where = mesh.name.empty() ? "mesh" : "mesh " + mesh.name;
  if (mesh.triangles.empty()) throw Error("mesh has no triangles", where, "check that the file holds faces");
  for (size_t i = 0; i < mesh.positions.size(); ++i)
    if (!mesh.positions[i].allFinite())
      throw Error("mesh has a vertex that is not finite", where + ", vertex " + std::to_string(i),
                  "repair the mesh");
  for (size_t i = 0; i < mesh.triangles.size(); ++i)
    for (const uint32_t index : mesh.triangles[i])
      if (index >= mesh.positions.size())
        throw Error("mesh has an index out of range",
                    where + ", triangle " + std::to_string(i) + ", vertex " + std::to_string(index) + " of " +
                        std::to_string(mesh.positions.size()),
                    "repair the mesh");
}

MeshCheck checkMesh(const TriangleMesh& mesh) {
  requireSoundMesh(mesh);
  MeshCheck check;
  check.triangles = mesh.triangles.size();
  const std::vector<uint32_t> place = vertexPlaces(mesh.positions);
  struct Edge {
    uint64_t places;  // numbers of the two positions, the lower in the high half
    uint32_t from, to;
  };
  std::vector<Edge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const auto& t : mesh.triangles) {
    const Vec3 &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
    if (!((b - a).cross(c - a).norm() > 0)) ++check.without_area;
    for (int i = 0; i < 3; ++i) {
      const uint32_t from = t[i], to = t[(i + 1) % 3];
      const uint64_t p = place[from], q = place[to];
      if (p != q) edges.push_back({std::min(p, q) << 32 | std::max(p, q), from, to});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    return std::tie(a.places, a.from, a.to) < std::tie(b.places, b.from, b.to);
  });
  for (size_t i = 0; i < edges.size();) {
    const Edge& first = edges[i];
    int excess = 0;
    for (; i < edges.size() && edges[i].places == first.places; ++i)
      excess += place[edges[i].from] == place[first.from] ? 1 : -1;
    const Vec3 &from = mesh.positions[first.from], &to = mesh.positions[first.to];
    if (excess > 0) check.open_edges.push_back({from, to, static_cast<float>(excess)});
    if (excess < 0) check.open_edges.push_back({to, from, static_cast<float>(-excess)});
  }
  return check;
}

}  // namespace strandcast
