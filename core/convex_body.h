#pragma once
#include <array>
#include <vector>

#include "core/triangle_mesh.h"

namespace strandcast {

/// What lies behind all of its planes. The distance from inside is exact; outside it is that to the farthest
/// plane, which before edges and corners is less than the distance to the body.
struct ConvexBody {
  std::vector<std::array<float, 4>> planes;  ///< unit normal out of the body; distance from the origin, m
  Box bounds;
};

/// The planes of a closed convex mesh, 1024 at most; triangles of one plane give one. Throws Error when a
/// vertex lies before the plane of a triangle by more than `tolerance` of the mesh's diagonal, when the mesh
/// is open or has no volume, and when there are too many.
ConvexBody convexBody(const TriangleMesh& mesh, float tolerance = 1e-4f);

}  // namespace strandcast
