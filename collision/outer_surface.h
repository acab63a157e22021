#pragma once
#include "collision/mesh_query.h"

namespace strandcast {

/// Whether the mesh winds about the point more than half a time, in either direction: a mesh turned inside
/// out is taken as it is meant.
bool isInside(const MeshQuery& query, const Vec3& point);

/// Whether there is outside at `place` of the surface, one `step` (m) along its normal or against it. Where
/// there is inside on both sides, something within the body or a part that reaches into another lies.
bool boundsOutside(const MeshQuery& query, const Vec3& place, const Vec3& step);

/// The same of a whole triangle, asked at its centroid and on a lattice of about `spacing` (m) up to its
/// corners until one place says so. A triangle without area is asked at the same places.
bool triangleBoundsOutside(const MeshQuery& query, const Vec3& a, const Vec3& b, const Vec3& c, float spacing,
                           float away);

}  // namespace strandcast
