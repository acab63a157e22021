#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "core/strand_set.h"

namespace strandcast {

/// Three guides between whose roots hair grows.
struct RootTriangle {
  std::array<uint32_t, 3> guides;
  float area;   ///< m^2, of the triangle of their roots
  bool parted;  ///< the guides part there, so a hair follows one of them only
};

/// Covers the area between guide roots with triangles: around each root, its nearest neighbours sorted by
/// angle in the tangent plane, taken in consecutive pairs. Inner triangles appear about three times, once per
/// corner, which keeps the density even. Left out are triangles across gaps (an edge far longer than the
/// usual spacing, or an angle over 120 degrees). Guides part when their directions near the root or from root
/// to tip differ by more than 60 degrees, or their lengths by more than a factor of 3. `usable` (per guide)
/// says which guides may take part.
std::vector<RootTriangle> rootTriangles(const StrandSet& guides, const std::vector<uint8_t>& usable);

}  // namespace strandcast
