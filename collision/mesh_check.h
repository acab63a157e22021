#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/triangle_mesh.h"

namespace strandcast {

/// Throws Error, with kind and location of the fault, on a mesh without triangles, a vertex that is not
/// finite, or an index out of range.
void requireSoundMesh(const TriangleMesh& mesh);

/// Per vertex, the number of its position. Vertices with equal coordinates share a number.
std::vector<uint32_t> vertexPlaces(const std::vector<Vec3>& positions);

/// An edge with unequal numbers of triangles in its two directions.
struct OpenEdge {
  Vec3 from, to;
  float excess;  ///< triangles that go from `from` to `to`, minus those in the other direction; positive
};

/// Result of checkMesh().
struct MeshCheck {
  size_t triangles = 0;
  size_t without_area = 0;  ///< triangles with collinear corners
  /// Empty for a closed mesh: then the winding number is an integer everywhere, even if the surface
  /// intersects itself.
  std::vector<OpenEdge> open_edges;
};

/// Finds open edges and degenerate triangles. Coincident vertices count as one, so that seams of texture
/// coordinates are no holes. Throws Error as requireSoundMesh.
MeshCheck checkMesh(const TriangleMesh& mesh);

}  // namespace strandcast
