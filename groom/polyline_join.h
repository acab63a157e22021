#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "groom/file_report.h"

namespace strandcast {

/// Polylines as runs of vertex indices: polyline `p` has corners[offsets[p]] to corners[offsets[p + 1]].
struct Polylines {
  std::vector<uint32_t> corners;
  std::vector<size_t> offsets{0};  ///< one more than polylines; none of them is empty

  size_t size() const { return offsets.size() - 1; }
  std::span<const uint32_t> at(size_t p) const {
    return std::span(corners).subspan(offsets[p], offsets[p + 1] - offsets[p]);
  }
  void end() { offsets.push_back(corners.size()); }
};

/// Joins the polylines of a file to strands.
///
/// A polyline that starts with the vertex that the one before it ended with continues it. That is all where a
/// file has polylines of three and more corners, or edges that are written strand after strand from the root
/// on. Other edges, which are polylines of two corners, are joined where two of them meet, whatever their
/// order and direction. Their strands then start at the end of the lower vertex index. They end where more
/// than two edges meet. Strands are in the order of their first edge. A ring of edges is opened at its lowest
/// index in any case.
///
/// `vertices`: how many there are; every corner is below. `report` is told of forks, rings, closed
/// polylines, strands that go through a vertex again, and edges that are left out because they are written
/// twice or have one vertex twice. Takes time and memory in proportion
/// to corners and vertices.
Polylines joinedPolylines(const Polylines& read, size_t vertices, FileReport& report);

}  // namespace strandcast
