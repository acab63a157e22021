// Strands from the polylines (`l`) of a Wavefront OBJ text.
#include <fmt/format.h>

#include <limits>
#include <set>

#include "io/groom_file.h"
#include "io/obj_lines.h"
#include "io/polyline_join.h"
#include "io/strand_edit.h"

namespace strandcast {
namespace {

struct ObjPolylines {
  std::vector<Vec3> vertices;
  Polylines lines, edge_faces;           ///< `l` statements, and `f` statements of two corners
  std::vector<size_t> line_of, edge_of;  ///< line of the file, 1-based, per polyline
  size_t faces = 0, points = 0, free_forms = 0, empty = 0;
  bool has_colours = false;
};

void addPolyline(const ObjLines& lines, size_t vertices, Polylines& to, std::vector<size_t>& line_of) {
  const auto& words = lines.words();
  for (size_t i = 1; i < words.size(); ++i) to.corners.push_back(lines.vertexIndex(words[i], vertices));
  to.end();
  line_of.push_back(lines.line());
}

ObjPolylines readPolylines(ObjLines& lines) {
  static const std::set<std::string_view> kFreeForms{"curv", "curv2", "surf"};
  ObjPolylines found;
  while (lines.next()) {
    const auto& words = lines.words();
    const std::string keyword = lines.keyword();
    if (keyword == "v") {
      found.vertices.push_back(lines.position());
      found.has_colours |= words.size() >= 7;
    } else if (keyword == "l") {
      if (words.size() > 1)
        addPolyline(lines, found.vertices.size(), found.lines, found.line_of);
      else
        ++found.empty;
    } else if (keyword == "f" && words.size() == 3) {
      addPolyline(lines, found.vertices.size(), found.edge_faces, found.edge_of);
    } else if (keyword == "f" || keyword == "fo") {
      ++found.faces;
    } else if (keyword == "p") {
      ++found.points;
    } else if (kFreeForms.contains(keyword)) {
      ++found.free_forms;
    }
  }
  return found;
}

/// Uses faces of two corners as edges of strands where the file has no polylines.
void takeEdgeFaces(ObjPolylines& found, FileReport& report) {
  if (found.edge_faces.size() == 0) return;
  if (found.lines.size() > 0) {
    leaveOutCount(report, found.edge_faces.size(), "face", " of two corners");
    return;
  }
  report.warnings.push_back(
      fmt::format("{} faces (f) of two corners are read as edges of strands", found.edge_faces.size()));
  found.lines = std::move(found.edge_faces);
  found.line_of = std::move(found.edge_of);
}

[[noreturn]] void refuseWithoutPolylines(const ObjLines& lines, const ObjPolylines& found) {
  if (found.free_forms > 0)
    lines.fail("the file has no polylines (l) but free-form shapes (curv, curv2, surf), which are not read",
               1, "convert the curves to polylines and export these");
  lines.fail(
      "the file has no polylines (l)", 1,
      found.faces > 0 ? "export the hair as polylines, not as a mesh" : "export the hair as polylines");
}

StrandSet strandsOf(const ObjPolylines& found, const Polylines& joined) {
  StrandSet strands;
  strands.positions.reserve(joined.corners.size());
  for (size_t s = 0; s < joined.size(); ++s) {
    for (const uint32_t v : joined.at(s)) strands.positions.push_back(found.vertices[v]);
    strands.offsets.push_back(static_cast<uint32_t>(strands.positions.size()));
  }
  return strands;
}

}  // namespace

RawGroom readObjStrands(std::span<const std::byte> bytes, const std::string& name) {
  ObjLines lines(bytes, name);
  if (bytes.empty()) lines.fail("the file is empty", 1);
  RawGroom groom;
  groom.format = "obj";
  groom.native_up = UpAxis::kY;
  ObjPolylines found = readPolylines(lines);
  takeEdgeFaces(found, groom.report);
  if (found.lines.size() == 0) refuseWithoutPolylines(lines, found);
  if (found.lines.corners.size() > std::numeric_limits<uint32_t>::max())
    lines.fail("the file has more than 4294967295 strand vertices", found.line_of.back(), "split the file");
  for (size_t l = 0; l < found.lines.size(); ++l)
    for (const uint32_t corner : found.lines.at(l))
      lines.checkIndex(corner, found.vertices.size(), found.line_of[l]);
  const Polylines joined = joinedPolylines(found.lines, found.vertices.size(), groom.report);
  if (joined.size() == 0)
    lines.fail("every polyline (l) goes from a vertex to itself", found.line_of.front(),
               "export the hair as polylines");
  groom.strands = strandsOf(found, joined);
  leaveOutNotFinite(groom.strands, groom.report, lines.where(found.line_of.front()));
  leaveOutCount(groom.report, found.empty, "polyline", " without vertices");
  leaveOutCount(groom.report, found.faces, "face", " (f)");
  leaveOutCount(groom.report, found.points, "statement", " of points (p)");
  leaveOutCount(groom.report, found.free_forms, "free-form shape", " (curv, curv2, surf)");
  leaveOutCount(groom.report, lines.unknown(), "statement", " that the format does not have");
  if (found.has_colours) groom.report.leaveOut("vertex colours");
  return groom;
}

}  // namespace strandcast
