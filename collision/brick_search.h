#pragma once
#include <cstdint>
#include <vector>

#include "collision/bake_loop.h"
#include "collision/mesh_query.h"
#include "core/distance_field.h"

namespace strandcast {

/// In the index while bricks are looked for.
constexpr uint32_t kCandidate = 0;

/// The index with kCandidate where a brick may come nearer to the mesh than the band, else kOutsideBrick.
/// Goes down from the whole grid in halves, so the work follows the surface and not the grid.
/// `done` is what progress tells.
std::vector<uint32_t> findBricks(const FieldGrid& grid, const MeshQuery& query, BakeLoop& loop,
                                 const BakeProgress& progress, double done);

}  // namespace strandcast
