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
  bool parted;  ///< the guides diverge, so a hair follows only one of them
};

/// Covers the area between guide roots with triangles. Around each root, its nearest neighbours are sorted by
/// angle in the tangent plane and taken in consecutive pairs. Inner triangles appear about three times, once
/// per corner, which keeps the density even. Triangles across gaps are left out: an edge far longer than the
/// usual spacing, or an angle over 120 degrees. Guides are parted where their directions near the root or
/// from root to tip differ by more than 60 degrees, or their lengths by more than a factor of 3. `usable`
/// (per guide): the guides that take part.
std::vector<RootTriangle> rootTriangles(const StrandSet& guides, const std::vector<uint8_t>& usable);

}  // namespace strandcast
