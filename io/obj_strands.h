// How the polylines of an OBJ text become strands. groom_file.h declares the reader.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "io/file_report.h"

namespace strandcast {

/// Polylines as runs of vertex indices: polyline `p` has corners[offsets[p]] to corners[offsets[p + 1]].
struct Polylines {
  std::vector<uint32_t> corners;
  std::vector<size_t> offsets{0};  ///< one more than there are polylines; no polyline is empty

  size_t size() const { return offsets.size() - 1; }
  std::span<const uint32_t> at(size_t p) const {
    return std::span(corners).subspan(offsets[p], offsets[p + 1] - offsets[p]);
  }
  void end() { offsets.push_back(corners.size()); }
};

/// Joins the polylines of a file into strands.
///
/// A polyline that starts with the vertex at which the previous one ended continues it. Nothing else is
/// joined in a file of polylines with three or more corners, or of edges written strand after strand from the
/// root on. Other edges (polylines of two corners) are joined where two of them meet, whatever their order
/// and direction. Such a strand starts at its end of lower vertex index and ends where more than two edges
/// meet. Strands are in the order of their first edge. A ring of edges is always opened at its lowest index.
///
/// `vertices`: number of vertices; all corners are below it. `report` receives forks, rings, closed
/// polylines, strands that pass a vertex twice, and edges that are left out because they repeat or have one
/// vertex twice. Time and memory are linear in corners and vertices.
Polylines joinedPolylines(const Polylines& read, size_t vertices, FileReport& report);

}  // namespace strandcast
