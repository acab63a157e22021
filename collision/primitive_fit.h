#pragma once
#include <vector>

#include "collision/mesh_query.h"
#include "core/contact_primitive.h"

namespace strandcast {

/// Options of fitSpheres().
struct PrimitiveFitOptions {
  int max_primitives = 24;
  float min_radius = 0.015f;  ///< m
  float skin = 0.0f;          ///< m, depth of the spheres below the surface
};

/// Spheres inside a closed or nearly closed mesh that fill it as well as `max_primitives` can. Candidates are
/// maximal inscribed spheres (shrinking balls, Ma 2012), selected greedily by the surface that they newly
/// cover. Deterministic. Throws Error as MeshQuery does, and when no sphere of `min_radius` fits.
std::vector<ContactPrimitive> fitSpheres(const TriangleMesh& mesh, const PrimitiveFitOptions& options);

}  // namespace strandcast
