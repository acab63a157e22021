#pragma once
#include "collision/field_bake.h"

namespace strandcast {

/// Box of the vertices that triangles use.
Box usedBounds(const TriangleMesh& mesh);

/// The grid about the mesh, at least the band away from it on every side. Throws Error when it is too large.
FieldGrid makeFieldGrid(const TriangleMesh& mesh, const FieldOptions& resolved);

}  // namespace strandcast
