#pragma once
#include "collision/body_distance.h"
#include "collision/field_bake.h"

namespace strandcast {

/// Compares a field with the distance that it was baked from at `points` random places of its band.
FieldAccuracy measureField(const DistanceField& field, const BodyDistance& body, size_t points,
                           const BakeProgress& progress);

}  // namespace strandcast
