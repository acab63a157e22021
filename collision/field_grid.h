#pragma once
#include "collision/field_bake.h"

namespace strandcast {

/// Bounding box of the vertices that triangles use.
Box usedBounds(const TriangleMesh& mesh);

/// Grid around the mesh with a margin of at least the band on each side. Throws Error when it is too large.
FieldGrid makeFieldGrid(const TriangleMesh& mesh, const FieldOptions& resolved);

}  // namespace strandcast
