#pragma once
#include <vector>

#include "collision/mesh_query.h"
#include "core/contact_primitive.h"

namespace strandcast {

struct PrimitiveFitOptions {
  int max_primitives = 24;
  float min_radius = 0.015f;  ///< m
  float skin = 0.0f;          ///< m, how far the spheres stay below the surface
};

/// Spheres inside a closed or nearly closed mesh that together fill it as well as `max_primitives` can:
/// maximal inscribed spheres (shrinking balls, Ma 2012), chosen greedily for the surface that they newly come
/// near to. Deterministic. Throws Error as MeshQuery does, and when no sphere of `min_radius` fits.
std::vector<ContactPrimitive> fitSpheres(const TriangleMesh& mesh, const PrimitiveFitOptions& options);

}  // namespace strandcast
