// Triangle meshes from Wavefront OBJ text.
#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "groom/mesh_file.h"
#include "groom/obj_lines.h"

namespace strandcast {
namespace {

struct ObjMeshReader {
  ObjLines lines;
  const std::vector<std::string>& skip_groups;
  TriangleMesh mesh;
  std::vector<size_t> triangle_lines;  ///< where each triangle came from, for errors found at the end
  bool skip_group = false;             ///< by the current `g`
  bool skip_object = false;            ///< by the current `o`

  bool isSkipped(const std::vector<std::string_view>& words) const {
    for (size_t i = 1; i < words.size(); ++i)
      for (const std::string& prefix : skip_groups)
        if (words[i].starts_with(prefix)) return true;
    return false;
  }

  /// Fans a polygon from its first corner. Triangles with a corner twice have no area and are left out.
  void addFace(const std::vector<std::string_view>& words) {
    if (words.size() < 4) lines.fail("a face has fewer than three corners", lines.line());
    const size_t vertices = mesh.positions.size();
    const uint32_t first = lines.vertexIndex(words[1], vertices);
    uint32_t before = lines.vertexIndex(words[2], vertices);
    for (size_t i = 3; i < words.size(); ++i) {
      const uint32_t here = lines.vertexIndex(words[i], vertices);
      if (first != before && before != here && here != first) {
        mesh.triangles.push_back({first, before, here});
        triangle_lines.push_back(lines.line());
      }
      before = here;
    }
  }

  void read() {
    while (lines.next()) {
      const auto& words = lines.words();
      if (words[0] == "v") {
        mesh.positions.push_back(lines.position());
      } else if (words[0] == "g") {
        skip_group = isSkipped(words);
      } else if (words[0] == "o") {
        skip_object = isSkipped(words);
      } else if (words[0] == "f" && !skip_group && !skip_object) {
        addFace(words);
      }
    }
  }

  void checkIndices() const {
    for (size_t t = 0; t < mesh.triangles.size(); ++t)
      for (const uint32_t corner : mesh.triangles[t])
        if (corner >= mesh.positions.size())
          lines.fail(fmt::format("vertex index {} is out of range, the file has {} vertices",
                                 uint64_t{corner} + 1, mesh.positions.size()),
                     triangle_lines[t]);
  }

  /// Vertices that no triangle uses (those of skipped groups) would spoil the bounding box.
  void dropUnusedVertices() {
    constexpr uint32_t kUnused = std::numeric_limits<uint32_t>::max();
    std::vector<uint32_t> renumbered(mesh.positions.size(), kUnused);
    for (const auto& triangle : mesh.triangles)
      for (const uint32_t corner : triangle) renumbered[corner] = 0;
    uint32_t kept = 0;
    for (size_t v = 0; v < mesh.positions.size(); ++v) {
      if (renumbered[v] == kUnused) continue;
      mesh.positions[kept] = mesh.positions[v];
      renumbered[v] = kept++;
    }
    mesh.positions.resize(kept);
    for (auto& triangle : mesh.triangles)
      for (uint32_t& corner : triangle) corner = renumbered[corner];
  }
};

}  // namespace

ReadMesh readObjMesh(std::span<const std::byte> bytes, const std::string& name,
                     const std::vector<std::string>& skip_groups) {
  ObjMeshReader reader{ObjLines(bytes, name), skip_groups, {}, {}, false, false};
  if (bytes.empty()) reader.lines.fail("the file is empty", 1);
  reader.read();
  reader.checkIndices();
  if (reader.mesh.triangles.empty())
    reader.lines.fail("the file has no faces (f) outside the groups that are skipped", 1,
                      "export the body as a mesh");
  reader.dropUnusedVertices();
  reader.mesh.name = name;
  computeNormals(reader.mesh);
  return {std::move(reader.mesh), {}};
}

}  // namespace strandcast
