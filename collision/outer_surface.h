#pragma once
#include <array>
#include <atomic>
#include <vector>

#include "collision/mesh_query.h"

namespace strandcast {

/// Whether the mesh winds about the point more than half a time, in either direction: a mesh turned inside
/// out is taken as it is meant.
bool isInside(const MeshQuery& query, const Vec3& point);

/// Whether there is outside at `place` of the surface, one `step` (m) along its normal or against it. Where
/// there is inside on both sides, something within the body or a part that reaches into another lies.
bool boundsOutside(const MeshQuery& query, const Vec3& place, const Vec3& step);

/// The parts of a triangle that bound the outside: the whole, none, or pieces of it, cut so that of what is
/// hidden a rim of about `resolution` (m) is left. Of a triangle with longer edges a hidden part is found
/// when it is larger than an eighth of them. A triangle without area is taken as any other. Returns early
/// when `stop` is set.
std::vector<std::array<Vec3, 3>> outerPieces(const MeshQuery& query, const std::array<Vec3, 3>& triangle,
                                             float resolution, const std::atomic<bool>& stop);

}  // namespace strandcast
