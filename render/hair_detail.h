#pragma once
#include <span>

#include "render/hair_growth.h"

namespace strandcast {

/// How much of the hair a picture draws: fewer hairs, each wider, and every `node_stride`-th node. A hair is
/// drawn where 1 - dither is below `threshold` x width x importance, so with the chance p of that product up
/// to 1, and width / p wide; what is left of its dither decides anew how many samples it reaches. The area
/// covered is right on average, and a hair that comes or goes reaches no sample then.
struct HairDetail {
  float threshold = 1e9f;  ///< above 0
  size_t hairs = 0;        ///< to draw, from the first on
  int node_stride = 1;
};

/// Hysteresis: a size that follows one that wavers only when that leaves a band below it, `band` (0 = none)
/// to either side of where it was. Never less than the true one, so that what is chosen by it is never too
/// coarse.
class HeldSize {
 public:
  float of(float size, float band);

 private:
  float held_ = 0;
};

/// The key by which hairs are sorted, largest first: those of a threshold t have 1 / t or more.
float detailKey(const Hair& hair);
/// Of hairs sorted by it, those of a part of them, above 0 to 1.
HairDetail detailOfPart(std::span<const Hair> hairs, float part);
/// The same, where a hair of width 1 has `hair_pixels` where it is nearest: without those that reach no
/// sample even there, if `finest` is the part of a pixel that a sample is; with a larger one fewer.
HairDetail detailOfSize(std::span<const Hair> hairs, float hair_pixels, float finest);
/// Part of the strands' length that is left when each is cut into so many straight pieces of equal arc
/// length.
double lengthKept(const StrandSet& strands, int pieces);
/// The node stride, a power of 2, at which segments that have `segment_pixels` where they are nearest stay
/// below `longest` pixels; at least `least_segments` of the `segments` are left.
int strideFor(float segment_pixels, float longest, int segments, int least_segments);

}  // namespace strandcast
