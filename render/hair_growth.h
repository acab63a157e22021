#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/strand_set.h"
#include "render/curl_example.h"
#include "render/scalp_map.h"

namespace strandcast {

/// How one hair follows the guides: 96 bytes, one layout for the CPU and for GLSL std430. With u the part of
/// the arc length from the root, P_k the guides' curves and N, B the twist-free frame of guide 0, the hair is
///   x(u) = P_0(u) + (1 - clump u) (spread_1(u) + spread_2(u) + beside_x N + beside_y B)
///          + across_x(u) N + across_y(u) B
/// with spread_k = weight_k (P_k - P_0) and what lies across the guide (the place in the lock, curls and
/// deviations) as hairAcross and exampleAcross of kernels/hair.h have it, for u in [0, extent]. Width is full
/// up to three quarters of the length and then falls linearly to nothing at the tip.
struct Hair {
  uint32_t guides[3];
  float dither;  ///< [0, 1): decides how many samples a hair narrower than a pixel reaches, and when it goes
  float weights[2];       ///< of guides 1 and 2, 0 or more; guide 0, the nearest root's, has the rest of 1
  float beside[2];        ///< m, from guide 0's root to the hair's, where guides part; else 0
  float offset[2];        ///< m, in the lock, times HairGrowth::lock_profile
  float clump;            ///< 0 to 1: how far the tip closes in on guide 0
  float extent;           ///< part of the guide's length, 0 to 1
  float width;            ///< times RenderSettings::hair_width
  float tip_deviation;    ///< m, at the tip
  float whole_deviation;  ///< m
  float deviation_phase;  ///< turns
  float curl_phase;       ///< turns
  float curl_radius;      ///< m
  float curl_turns;       ///< over the guide's length
  float shade;            ///< -1 darker to 1 lighter
  float warmth;           ///< -1 ashen to 1 red
  float importance;     ///< above 0 to 1: how long it stays when hairs are left out, as a factor of its width
  float example_scale;  ///< m, of HairGrowth::curl_example, turned by curl_phase; 0 without
  float first_sample;   ///< [0, 1), of a pixel's, that it reaches; what `dither` is says nothing of it
};
static_assert(sizeof(Hair) == 96);

/// Where a guide's twist-free frame starts: unit, perpendicular to its first edge and to each other.
struct RootFrame {
  Vec3 normal, binormal;
};
RootFrame rootFrame(std::span<const Vec3> points);

enum class Interpolation {
  kMultiStrand,   ///< every hair between three guides, from root to tip
  kSingleStrand,  ///< every hair in a lock about one guide
  kCombined       ///< between three guides at the root, closing in on one towards the tip; some in locks
};

struct HairGrowth {
  size_t hairs = 40000;
  Interpolation interpolation = Interpolation::kCombined;
  float clump_radius = 0.004f;          ///< m, of a lock
  Vec3 lock_profile{1.0f, 0.7f, 0.4f};  ///< factors of it at root, middle and tip, 0 or more
  float single_strand_part = 0.3f;      ///< of the hairs that are in locks (combined)
  float clump = 0.75f;                  ///< 0 to 1: how far tips close in on one guide at most (combined)
  float tip_deviation = 0.006f;         ///< m, of the hairs that stray near their tip, at most
  float tip_deviation_part = 0.3f;      ///< of the hairs
  float whole_deviation = 0.003f;       ///< m, of those that stray along their whole length, at most
  float whole_deviation_part = 0.1f;    ///< of the hairs
  float curl_radius = 0;                ///< m; 0 = no curls
  float curl_pitch = 0.03f;             ///< m of length a turn
  std::shared_ptr<const CurlExample>
      curl_example{};                            ///< laid on hairs in proportion to their length; null = none
  std::shared_ptr<const ScalpMap> density{};     ///< part of the hairs that grow; null = all
  std::shared_ptr<const ScalpMap> thickness{};   ///< factor of their width, 0 grows none; null = 1
  std::shared_ptr<const ScalpMap> importance{};  ///< Hair::importance, of 0.02 or more; null = 1
  uint64_t seed = 1;

  bool operator==(const HairGrowth&) const = default;
};

/// What the shaders know of all hairs at once: the std140 block of shaders/hair_curve.glsl, field for field.
struct GrowthBlock {
  float profile[3];  ///< HairGrowth::lock_profile
  float unused = 0;
  uint32_t segments;    ///< of the guides' nodes
  uint32_t bodies = 0;  ///< that hair is kept out of
  float clearance = 0;  ///< m, that it keeps from them
  float zone = 0.15f;   ///< part of the length over which a hair goes over to one guide before a body
  std::array<CurlExample::Sample, CurlExample::kParts + 1> example{};
};
static_assert(sizeof(GrowthBlock) == 32 + 16 * 257);

/// Distributes hairs over the area that the guides' roots cover and chooses the guides that each follows.
/// Guides with fewer than 2 vertices, a vertex that is not finite, or no length get no hairs. The same input
/// gives the same hairs, and every hair has random numbers of its own: what one setting or map changes leaves
/// the rest as it was. Sorted by detailKey(), largest first.
std::vector<Hair> growHairs(const StrandSet& guides, const HairGrowth& growth);

}  // namespace strandcast
