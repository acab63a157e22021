#pragma once
#include <cstdint>
#include <vector>

#include "collision/bake_loop.h"
#include "collision/mesh_query.h"
#include "core/distance_field.h"

namespace strandcast {

/// Value of an index entry during the search: the brick is to be stored.
constexpr uint32_t kCandidate = 0;

/// Index of the grid with kCandidate for bricks that may come nearer to the mesh than the band, else
/// kOutsideBrick. The grid is subdivided as an octree, so the work scales with the surface and not with the
/// grid. `done`: value reported as progress.
std::vector<uint32_t> findBricks(const FieldGrid& grid, const MeshQuery& query, BakeLoop& loop,
                                 const BakeProgress& progress, double done);

}  // namespace strandcast
