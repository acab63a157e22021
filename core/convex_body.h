#pragma once
#include <array>
#include <vector>

#include "core/triangle_mesh.h"

namespace strandcast {

/// Intersection of half spaces. Distances are exact inside. Outside, the distance is that to the farthest
/// plane: a lower bound in front of edges and corners.
struct ConvexBody {
  std::vector<std::array<float, 4>> planes;  ///< unit normal out of the body; distance from the origin, m
  Box bounds;
};

/// Planes of a closed convex mesh, at most 1024; coplanar triangles share one. Throws Error if a vertex lies
/// in front of a triangle's plane by more than `tolerance` x the mesh's diagonal. Also if the mesh is open,
/// has no volume or has too many planes.
ConvexBody convexBody(const TriangleMesh& mesh, float tolerance = 1e-4f);

}  // namespace strandcast
