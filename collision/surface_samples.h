#pragma once
#include <vector>

#include "collision/mesh_query.h"
#include "core/triangle_mesh.h"

namespace strandcast {

/// A point of a surface with its normal.
struct SurfaceSample {
  Vec3 position;  ///< m
  Vec3 normal;    ///< unit length, of its triangle
};

/// `count` points distributed over the surface by area, fewer if triangles have no area. Barycentric
/// coordinates follow a golden-ratio sequence. Each point represents the same area.
std::vector<SurfaceSample> sampleSurface(const TriangleMesh& mesh, size_t count);

/// Share, 0 to 1, of the surface of `mesh` where the inside-outside test is uncertain on one side, at a
/// distance `step` (m). Uncertain: the magnitude of the winding number is nearer to a half than to an
/// integer.
double shareInDoubt(const TriangleMesh& mesh, const MeshQuery& query, float step);

}  // namespace strandcast
