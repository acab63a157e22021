// Strands from the polylines (`l`) of a Wavefront OBJ text.
#include <fmt/format.h>

#include <limits>

#include "groom/groom_file.h"
#include "groom/obj_lines.h"

namespace strandcast {
namespace {

/// The corners of one `l` statement, a run in the list of all corners.
struct Polyline {
  size_t first, count, line;
};

struct Polylines {
  std::vector<Vec3> vertices;
  std::vector<uint32_t> corners;
  std::vector<Polyline> lines;
};

Polylines readPolylines(ObjLines& lines) {
  Polylines found;
  while (lines.next()) {
    const auto& words = lines.words();
    if (words[0] == "v") {
      found.vertices.push_back(lines.position());
    } else if (words[0] == "l") {
      if (words.size() < 2) lines.fail("a polyline has no vertices", lines.line());
      found.lines.push_back({found.corners.size(), words.size() - 1, lines.line()});
      for (size_t i = 1; i < words.size(); ++i)
        found.corners.push_back(lines.vertexIndex(words[i], found.vertices.size()));
    }
  }
  return found;
}

}  // namespace

RawGroom readObjStrands(std::span<const std::byte> bytes, const std::string& name) {
  ObjLines lines(bytes, name);
  if (bytes.empty()) lines.fail("the file is empty", 1);
  const Polylines found = readPolylines(lines);
  if (found.lines.empty())
    lines.fail("the file has no polylines (l)", 1, "export the hair as curves or polylines, not as a mesh");
  if (found.corners.size() > std::numeric_limits<uint32_t>::max())
    lines.fail("the file has more than 4294967295 strand vertices", found.lines.back().line,
               "split the file");

  RawGroom groom;
  groom.format = "obj";
  groom.native_up = UpAxis::kY;
  StrandSet& strands = groom.strands;
  strands.positions.reserve(found.corners.size());
  for (size_t l = 0; l < found.lines.size(); ++l) {
    const Polyline& line = found.lines[l];
    // Some programs write a curve as one `l a b` per edge: a polyline that starts where the one before it
    // ended is the same strand going on.
    const bool goes_on = l > 0 && found.corners[line.first] == found.corners[line.first - 1];
    if (goes_on) strands.offsets.pop_back();
    for (size_t i = goes_on ? 1 : 0; i < line.count; ++i) {
      const uint32_t corner = found.corners[line.first + i];
      if (corner >= found.vertices.size())
        lines.fail(fmt::format("vertex index {} is out of range, the file has {} vertices",
                               uint64_t{corner} + 1, found.vertices.size()),
                   line.line);
      strands.positions.push_back(found.vertices[corner]);
    }
    strands.offsets.push_back(static_cast<uint32_t>(strands.positions.size()));
  }
  return groom;
}

}  // namespace strandcast
