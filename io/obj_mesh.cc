// Triangle meshes from Wavefront OBJ text.
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <set>

#include "io/mesh_file.h"
#include "io/obj_lines.h"
#include "io/polygon.h"

namespace strandcast {
namespace {

/// Corners of one `f` statement: a range in the list of all corners.
struct ObjFace {
  size_t first, count, line;
};

struct ObjMeshReader {
  ObjLines lines;
  const std::vector<std::string>& skip_groups;
  ReadMesh read_mesh{};
  std::vector<uint32_t> corners{};
  std::vector<ObjFace> faces{};
  bool skip_group = false;   ///< the current `g` is skipped
  bool skip_object = false;  ///< the current `o` is skipped
  size_t skipped = 0, flat = 0, polylines = 0, points = 0, free_forms = 0;

  TriangleMesh& mesh() { return read_mesh.mesh; }

  bool isSkipped(const std::vector<std::string_view>& words) const {
    for (size_t i = 1; i < words.size(); ++i)
      for (const std::string& prefix : skip_groups)
        if (words[i].starts_with(prefix)) return true;
    return false;
  }

  void addFace(const std::vector<std::string_view>& words) {
    if (words.size() < 4) {
      ++flat;
      return;
    }
    faces.push_back({corners.size(), words.size() - 1, lines.line()});
    for (size_t i = 1; i < words.size(); ++i)
      corners.push_back(lines.vertexIndex(words[i], mesh().positions.size()));
  }

  void read() {
    static const std::set<std::string_view> kFreeForms{"curv", "curv2", "surf"};
    while (lines.next()) {
      const auto& words = lines.words();
      const std::string keyword = lines.keyword();
      if (keyword == "v") {
        mesh().positions.push_back(lines.position());
      } else if (keyword == "g") {
        skip_group = isSkipped(words);
      } else if (keyword == "o") {
        skip_object = isSkipped(words);
      } else if (keyword == "f" || keyword == "fo") {  // fo: faces in files before version 3.0
        if (skip_group || skip_object)
          ++skipped;
        else
          addFace(words);
      } else if (keyword == "l") {
        ++polylines;
      } else if (keyword == "p") {
        ++points;
      } else if (kFreeForms.contains(keyword)) {
        ++free_forms;
      }
    }
  }

  /// Triangulates the faces. Faces with a vertex that is not finite are left out.
  void triangulate() {
    size_t not_finite = 0, unclear = 0, first_unclear = 0;
    PolygonCutter cutter(mesh().positions);
    for (const ObjFace& face : faces) {
      const std::span<const uint32_t> ring = std::span(corners).subspan(face.first, face.count);
      for (const uint32_t corner : ring) lines.checkIndex(corner, mesh().positions.size(), face.line);
      if (!std::all_of(ring.begin(), ring.end(),
                       [&](uint32_t v) { return mesh().positions[v].allFinite(); })) {
        ++not_finite;
        continue;
      }
      const size_t before = mesh().triangles.size();
      const bool is_covered = cutter.cut(ring, mesh().triangles);
      if (cutter.isSpent())
        lines.fail("the faces have too many corners to be cut into triangles", face.line,
                   "triangulate the mesh before it is exported");
      if (mesh().triangles.size() == before) {
        ++flat;
      } else if (!is_covered && ++unclear == 1) {
        first_unclear = face.line;
      }
    }
    addOmissionCount(read_mesh.report, not_finite, "face", " with a position that is not finite");
    addOmissionCount(read_mesh.report, flat, "face", " of fewer than three different corners");
    if (unclear > 0)
      read_mesh.report.warnings.push_back(
          fmt::format("{} face{}, the first in line {}: the triangles are a guess", unclear,
                      unclear == 1 ? " has no area or crosses itself" : "s have no area or cross themselves",
                      first_unclear));
  }

  void reportRest() {
    FileReport& report = read_mesh.report;
    addOmissionCount(report, skipped, "face",
                     fmt::format(" of groups whose names begin with {}", fmt::join(skip_groups, " or ")));
    addOmissionCount(report, polylines, "polyline", " (l)");
    addOmissionCount(report, points, "statement", " of points (p)");
    addOmissionCount(report, free_forms, "free-form shape", " (curv, curv2, surf)");
    addOmissionCount(report, lines.unknown(), "statement", " that the format does not have");
  }

  /// Removes vertices that no triangle uses (those of skipped groups): they would falsify the bounding box.
  void dropUnusedVertices() {
    constexpr uint32_t kUnused = std::numeric_limits<uint32_t>::max();
    std::vector<uint32_t> renumbered(mesh().positions.size(), kUnused);
    for (const auto& triangle : mesh().triangles)
      for (const uint32_t corner : triangle) renumbered[corner] = 0;
    uint32_t kept = 0;
    for (size_t v = 0; v < mesh().positions.size(); ++v) {
      if (renumbered[v] == kUnused) continue;
      mesh().positions[kept] = mesh().positions[v];
      renumbered[v] = kept++;
    }
    mesh().positions.resize(kept);
    for (auto& triangle : mesh().triangles)
      for (uint32_t& corner : triangle) corner = renumbered[corner];
  }
};

}  // namespace

ReadMesh readObjMesh(std::span<const std::byte> bytes, const std::string& name,
                     const std::vector<std::string>& skip_groups) {
  ObjMeshReader reader{ObjLines(bytes, name), skip_groups};
  if (bytes.empty()) reader.lines.fail("the file is empty", 1);
  reader.read();
  reader.triangulate();
  if (reader.mesh().triangles.empty())
    reader.lines.fail(
        reader.free_forms > 0
            ? "the file has no faces (f) but free-form shapes (curv, curv2, surf), which are not read"
            : "the file has no faces (f) outside the groups that are skipped",
        1,
        reader.free_forms > 0 ? "convert the surfaces to polygons and export these"
                              : "export the body as a mesh");
  reader.reportRest();
  reader.dropUnusedVertices();
  reader.mesh().name = name;
  computeNormals(reader.mesh());
  return std::move(reader.read_mesh);
}

}  // namespace strandcast
