// The scalp: maps over it, and the area between the roots of guides.
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/strand_set.h"

namespace strandcast {

/// Values over the scalp, 0 to 1, e.g. density or thickness of hair.
struct ScalpMap {
  int width = 0, height = 0;  ///< at least 1
  std::vector<float> values;  ///< width x height, top row first

  /// Bilinear; `place` is from ScalpPlaces. The map's left and right edges are adjacent (periodic).
  float at(const Vec2& place) const;
};

/// Reads the mean of the three channels of a PNG file, black 0 and white 1. Throws Error as readPng.
ScalpMap readScalpMap(const std::filesystem::path& file);

/// Map coordinates of roots, 0 to 1 from the left and from the top. They are the strands' uvs where the groom
/// has them. Otherwise they are longitude and latitude about the centre of the roots' bounding box, with the
/// face (+Z) in the middle and the crown at the top.
class ScalpPlaces {
 public:
  explicit ScalpPlaces(const StrandSet& guides);
  /// Of a root between three guides; `weights`: of the second and the third.
  Vec2 of(const uint32_t (&guides)[3], const float (&weights)[2]) const;

 private:
  const StrandSet& guides_;
  Vec3 middle_ = Vec3::Zero();
};

/// Three guides between whose roots hair grows.
struct RootTriangle {
  std::array<uint32_t, 3> guides;
  float area;   ///< m^2, of the triangle of their roots
  bool parted;  ///< two of the guides part, so a hair follows only one of them
};

/// Covers the area between guide roots with triangles. Around each root, its nearest neighbours are sorted by
/// angle in the tangent plane and taken in consecutive pairs. Inner triangles appear about three times, once
/// per corner, which keeps the density even. Triangles across gaps are left out: an edge far longer than the
/// usual spacing, or an angle over 120 degrees. Which guides are parted: isParting() in groom/neighbors.h.
/// `usable` (per guide): the guides that take part.
std::vector<RootTriangle> rootTriangles(const StrandSet& guides, const std::vector<uint8_t>& usable);

}  // namespace strandcast
