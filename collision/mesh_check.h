#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/triangle_mesh.h"

namespace strandcast {

/// Throws Error, saying which and where: no triangles, a vertex that is not finite, an index out of range.
void requireSoundMesh(const TriangleMesh& mesh);

/// For each vertex the number of its place: vertices with the same coordinates have the same.
std::vector<uint32_t> vertexPlaces(const std::vector<Vec3>& positions);

/// An edge that has not as many triangles one way round as the other.
struct OpenEdge {
  Vec3 from, to;
  float excess;  ///< triangles that go from `from` to `to`, less those that go back; positive
};

struct MeshCheck {
  size_t triangles = 0;
  size_t without_area = 0;  ///< triangles whose corners lie on one line
  /// Of a closed mesh none: then the winding number is whole everywhere, however the surface meets itself.
  std::vector<OpenEdge> open_edges;
};

/// Vertices in the same place count as one, so that seams of texture coordinates are no holes. Throws Error
/// as requireSoundMesh.
MeshCheck checkMesh(const TriangleMesh& mesh);

}  // namespace strandcast
