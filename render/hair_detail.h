#pragma once
#include <span>
#include <vector>

#include "render/hair_growth.h"

namespace strandcast {

/// How much of the hair a picture draws: fewer hairs, each wider, that cover the same area (Cook, Halstead,
/// Planck, Ryu 2007, "Stochastic simplification of aggregate detail"), and every `node_stride`-th node.
struct HairDetail {
  float part = 1;         ///< of the hairs, above 0 to 1
  float width_scale = 1;  ///< of those that are left
  float fade = 1e9f;      ///< 1 / the part over which the last of them thin out to nothing
  size_t hairs = 0;       ///< to draw, from the first on
  int node_stride = 1;
};

/// Widths of hairs, summed, so that any part of them can be made to cover as much as all.
class HairWidths {
 public:
  explicit HairWidths(std::span<const Hair> hairs);
  /// `part` is clipped to between one hair and all of them. Continuous in it: a hair comes and goes by its
  /// width.
  HairDetail detail(float part) const;

 private:
  std::vector<double> sums_, moments_;  ///< of the first n hairs: widths, and widths x rank
};

/// The part of the hairs to draw when a hair of width 1 has `hair_pixels` where it is nearest: so many that
/// none is thinner than `finest` pixels.
float partFor(float hair_pixels, float finest);
/// The node stride, a power of 2, at which segments that have `segment_pixels` where they are nearest stay
/// below `longest` pixels; at least `least_segments` of the `segments` are left.
int strideFor(float segment_pixels, float longest, int segments, int least_segments);

}  // namespace strandcast
