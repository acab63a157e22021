#pragma once
#include "collision/body_distance.h"
#include "collision/field_bake.h"

namespace strandcast {

/// Compares a field with the exact distance of `body` at `points` random points of its band.
FieldAccuracy measureField(const DistanceField& field, const BodyDistance& body, size_t points,
                           const BakeProgress& progress);

}  // namespace strandcast
