#pragma once
#include <array>
#include <atomic>
#include <vector>

#include "collision/mesh_query.h"

namespace strandcast {

/// Inside-outside test: whether the magnitude of the winding number is above a half. Thereby an inside-out
/// mesh has the same inside.
bool isInside(const MeshQuery& query, const Vec3& point);

/// Whether there is outside on either side of the surface at `place`, at a distance `step` (m, along the
/// normal). If both sides are inside, the surface there is an internal part, or a part that reaches into
/// another one.
bool boundsOutside(const MeshQuery& query, const Vec3& place, const Vec3& step);

/// The parts of a triangle that bound the outside: the whole, none, or pieces of it. Pieces are cut so that a
/// rim of about `resolution` (m) of the hidden part remains. In a triangle with edges longer than that, a
/// hidden part is found if it is larger than an eighth of the edges. Triangles without area are treated
/// alike. Returns early when `stop` is set.
std::vector<std::array<Vec3, 3>> outerPieces(const MeshQuery& query, const std::array<Vec3, 3>& triangle,
                                             float resolution, const std::atomic<bool>& stop);

}  // namespace strandcast
