#pragma once
#include <filesystem>
#include <vector>

#include "core/strand_set.h"

namespace strandcast {

/// Numbers over the scalp, 0 to 1, e.g. how dense or how thick hair is there.
struct ScalpMap {
  int width = 0, height = 0;  ///< 1 or more
  std::vector<float> values;  ///< width x height, top row first

  /// Bilinear; `place` as ScalpPlaces gives it. The map's left and right edges meet.
  float at(const Vec2& place) const;
};

/// The mean of the three channels of a PNG file, black 0 and white 1. Throws Error as readPng.
ScalpMap readScalpMap(const std::filesystem::path& file);

/// Where roots are on the scalp, 0 to 1 from the left and from the top of a map: the strands' uvs where the
/// groom has them; else longitude and latitude about the middle of the roots' bounding box, the face (+Z) in
/// the middle and the crown on top.
class ScalpPlaces {
 public:
  explicit ScalpPlaces(const StrandSet& guides);
  /// Of a root between three guides, with the weights of the second and the third.
  Vec2 of(const uint32_t (&guides)[3], const float (&weights)[2]) const;

 private:
  const StrandSet& guides_;
  Vec3 middle_ = Vec3::Zero();
};

}  // namespace strandcast
