#pragma once
#include <span>

#include "render/hair_growth.h"

namespace strandcast {

/// The level of detail of the hair in a picture: fewer hairs, each wider, and every `node_stride`-th node.
/// Let p be `threshold` x width x importance, clamped to 1. A hair is drawn where 1 - dither is below p,
/// hence with probability p, and its width is divided by p. The rest of its dither selects how many samples
/// it covers. The expected covered area is unchanged, and a hair that appears or disappears covers no sample
/// at that moment.
struct HairDetail {
  float threshold = 1e9f;  ///< above 0
  size_t hairs = 0;        ///< number of hairs to draw, from the first
  int node_stride = 1;
};

/// A size with hysteresis. The held size is `band` (0 = none) larger than the true one and changes only where
/// the true one exceeds it or falls below it by (1 + band)^2. It is never less than the true one, so a level
/// of detail chosen by it is never too coarse.
class HysteresisSize {
 public:
  /// Returns the held size for the present true size.
  float of(float size, float band);

 private:
  float held_ = 0;
};

/// The sort key of hairs, largest first: a threshold t draws those with a key of at least 1 / t.
float detailKey(const Hair& hair);
/// The detail that draws the fraction `part`, above 0 to 1, of sorted hairs.
HairDetail detailOfPart(std::span<const Hair> hairs, float part);
/// The detail for a hair of width 1 that covers `hair_pixels` pixels at its nearest point. With `finest` the
/// size of a sample in pixels, only hairs that cover no sample there are left out; a larger value leaves out
/// more.
HairDetail detailOfSize(std::span<const Hair> hairs, float hair_pixels, float finest);
/// The fraction of the strands' length that remains when each is replaced by `pieces` chords of equal arc
/// length.
double lengthKept(const StrandSet& strands, int pieces);
/// The largest node stride, a power of 2, that keeps segments of `segment_pixels` pixels at their nearest
/// point within `longest` pixels, and leaves at least `min_segments` of the `segments`.
int strideFor(float segment_pixels, float longest, int segments, int min_segments);

}  // namespace strandcast
