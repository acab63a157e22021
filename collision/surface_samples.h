#pragma once
#include <vector>

#include "collision/mesh_query.h"
#include "core/triangle_mesh.h"

namespace strandcast {

struct SurfaceSample {
  Vec3 position;  ///< m
  Vec3 normal;    ///< unit length, of its triangle
};

/// `count` places spread over the surface by area, fewer where triangles have no area; the barycentric
/// coordinates follow a golden-ratio sequence. Each stands for the same area.
std::vector<SurfaceSample> sampleSurface(const TriangleMesh& mesh, size_t count);

/// The share, 0 to 1, of the surface of `mesh` on one side of which, a `step` (m) away, it is in doubt
/// whether there is inside: the winding number's size is nearer to a half than to a whole number of either
/// side.
double shareInDoubt(const TriangleMesh& mesh, const MeshQuery& query, float step);

}  // namespace strandcast
