#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "core/strand_set.h"

namespace strandcast {

/// How one hair follows the guides: 64 bytes, one layout for the CPU and for GLSL std430. With u the part of
/// the arc length from the root, P_k the guides' curves and N, B the twist-free frame of guide 0, the hair is
///   x(u) = sum_k w_k(u) P_k(u) + taper(u) (offset_x N + offset_y B) + stray u^2 (cos(a) N + sin(a) B)
/// with w(u) = (1 - clump u) weights + clump u (1, 0, 0), taper(u) = 1 - 0.6 u, a = phase + 9 u, for u in [0,
/// extent]. Width is full up to three quarters of the length and then falls linearly to nothing at the tip.
struct Hair {
  uint32_t guides[3];
  float dither;      ///< [0, 1): decides which samples a hair narrower than a pixel reaches
  float weights[3];  ///< sum to 1; 1, 0, 0 is single-strand interpolation
  float clump;       ///< 0 to 1: how far the tip closes in on guide 0
  float offset[2];   ///< m
  float extent;      ///< part of the guide's length, 0 to 1
  float width;       ///< times RenderSettings::hair_width
  float stray;       ///< m
  float phase;       ///< rad
  float shade;       ///< -1 darker to 1 lighter
  float warmth;      ///< -1 ashen to 1 red
};
static_assert(sizeof(Hair) == 64);

/// Where a guide's twist-free frame starts: unit, perpendicular to its first edge and to each other.
struct RootFrame {
  Vec3 normal, binormal;
};
RootFrame rootFrame(std::span<const Vec3> points);

struct HairGrowth {
  size_t hairs = 40000;
  float clump_radius = 0.004f;      ///< m
  float single_strand_part = 0.3f;  ///< of the hairs
  uint64_t seed = 1;
};

/// Distributes hairs over the area that the guides' roots cover and chooses the guides that each follows.
/// Guides with fewer than 2 vertices, a vertex that is not finite, or no length get no hairs. The same input
/// gives the same hairs. Sorted by width / (1 - dither), largest first, so that the hairs that reach a sample
/// at a given distance are a prefix (see hairsReaching).
std::vector<Hair> growHairs(const StrandSet& guides, const HairGrowth& growth);

/// How many of `hairs`, from the first, can have floor(coverage * samples + dither) > 0 when a hair of width
/// 1 covers at most `coverage` of a pixel: the part of stochastic transparency (Enderton et al. 2010) that
/// can be decided before drawing.
size_t hairsReaching(const std::vector<Hair>& hairs, float coverage, int samples);

}  // namespace strandcast
