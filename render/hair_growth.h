// How each hair of a groom follows the guides and differs from its neighbours.
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/geometry.h"
#include "core/strand_set.h"
#include "render/scalp.h"

namespace strandcast {

/// The curl of one strand, to be applied to grown hair: its offset from its smoothed axis, sampled at equal
/// parts u of the axis's length and divided by that length. The axis is the least squares cubic through the
/// root; slower bends than that are the guides' shape, not curl. Offsets are along the normal and binormal of
/// the axis's twist-free frame (kernels/hair.h, carriedNormal). The component along the axis is omitted, so a
/// strand that turns back on itself loses its loops.
struct CurlExample {
  static constexpr int kParts = 256;
  struct Sample {
    float x, y;              ///< along normal and binormal, over the axis's length; 0 at the root
    float slope_x, slope_y;  ///< derivatives with respect to u
  };
  std::array<Sample, kParts + 1> samples;
  float axis_length;  ///< in the strand's unit
  float reach;        ///< largest offset of a sample, over the axis's length
  float turns;        ///< absolute turns about the axis; a planar wave counts one per period
};

/// Throws Error, naming `where`, for a strand of fewer than 5 vertices, with vertices that are not finite, or
/// without length.
CurlExample curlOf(std::span<const Vec3> strand, const std::string& where);
/// The curl of strand `strand`, from 0, of a groom file (io/groom_file.h). Throws Error as readRawGroom()
/// and curlOf(), and where the file has no such strand.
CurlExample readCurlExample(const std::filesystem::path& file, size_t strand);

/// How one hair follows the guides: 112 bytes, one layout for the CPU and for GLSL std430. A hair that is
/// bound to its guides (groom/bound_growth.h) has its shape in BoundHairs; of the fields before `importance`,
/// only guides, dither, weights, width, shade and warmth count. Of other hairs, let u be the fraction of the
/// arc length from the root, P_k the guides' curves and N, B the twist-free frame of guide 0. The hair is
///   x(u) = P_0(u) + (1 - clump u) (spread_1(u) + spread_2(u) + beside_x N + beside_y B)
///          + across_x(u) N + across_y(u) B
/// with spread_k = weight_k (P_k - P_0), for u in [0, extent]. The offset across the guide (position in the
/// lock, curls and deviations) is by hairAcross and exampleAcross of kernels/hair.h. Width is constant up to
/// three quarters of the length and then falls linearly to zero at the tip.
struct Hair {
  uint32_t guides[3];
  float dither;  ///< [0, 1): controls how many samples a hair narrower than a pixel covers, and when level of
                 ///< detail drops it
  float weights[2];  ///< of guides 1 and 2, at least 0; guide 0, that of the nearest root, has the rest of 1
  float beside[2];   ///< m, from guide 0's root to the hair's, where guides part; else 0
  float offset[2];   ///< m, position in the lock, scaled by HairGrowth::lock_profile
  float clump;       ///< 0 to 1: how far the tip closes in on guide 0
  float extent;      ///< fraction of the guide's length, 0 to 1
  float width;       ///< factor of RenderSettings::hair_width
  float tip_deviation;    ///< m, at the tip
  float whole_deviation;  ///< m
  float deviation_phase;  ///< turns
  float curl_phase;       ///< turns
  float curl_radius;      ///< m
  float curl_turns;       ///< over the guide's length
  float shade;            ///< -1 darker to 1 lighter
  float warmth;           ///< -1 ashen to 1 red
  float importance;  ///< above 0 to 1: factor of its width in the order in which level of detail drops hairs
  float example_scale;  ///< m, scale of HairGrowth::curl_example, rotated by curl_phase; 0 = none
  float first_sample;   ///< [0, 1), of a pixel's samples, the first one that it covers; independent of
                        ///< `dither`
  uint32_t color;       ///< sRGB, red in the lowest byte, and bit 24; 0 = that of the settings
  uint32_t bound;       ///< index plus 1 of a bound hair in BoundHairs; 0 = grown from a seed
  float reach;          ///< m, largest distance of a bound hair from its guides; else 0
  float unused;
};
static_assert(sizeof(Hair) == 112);

constexpr float kLeastImportance = 0.02f;  ///< of Hair::importance

/// The initial axes of a guide's twist-free frame: unit, perpendicular to its first edge and to each other.
struct RootFrame {
  Vec3 normal, binormal;
};
/// The frame at the root of a guide with these vertices.
RootFrame rootFrame(std::span<const Vec3> points);

/// How hairs are interpolated from guides.
enum class Interpolation {
  kMultiStrand,   ///< every hair between three guides, from root to tip
  kSingleStrand,  ///< every hair in a lock about one guide
  kCombined       ///< between three guides at the root, closing in on one towards the tip; some in locks
};

/// Parameters of growing hairs from guides.
struct HairGrowth {
  size_t hairs = 40000;
  Interpolation interpolation = Interpolation::kCombined;
  float clump_radius = 0.004f;          ///< m, radius of a lock
  Vec3 lock_profile{1.0f, 0.7f, 0.4f};  ///< factors of the radius at root, middle and tip, at least 0
  float single_strand_part = 0.3f;      ///< fraction of the hairs that are in locks (combined)
  float clump = 0.75f;                  ///< 0 to 1: largest closing of tips on one guide (combined)
  float tip_deviation = 0.006f;         ///< m, largest deviation of hairs that stray near their tip
  float tip_deviation_part = 0.3f;      ///< fraction of the hairs
  float whole_deviation = 0.003f;       ///< m, largest deviation of hairs that stray along their whole length
  float whole_deviation_part = 0.1f;    ///< fraction of the hairs
  float curl_radius = 0;                ///< m; 0 = no curls
  float curl_pitch = 0.03f;             ///< m of length per turn
  std::shared_ptr<const CurlExample> curl_example{};  ///< scaled with the hair's length; null = none
  std::shared_ptr<const ScalpMap> density{};          ///< fraction of the hairs that grow; null = all
  std::shared_ptr<const ScalpMap> thickness{};        ///< factor of the width, 0 grows none; null = 1
  std::shared_ptr<const ScalpMap> importance{};  ///< Hair::importance, clamped to kLeastImportance; null = 1
  uint64_t seed = 1;

  bool operator==(const HairGrowth&) const = default;
};

/// Shader parameters common to all hairs: the std140 block of shaders/hair_curve.glsl, field for field.
struct GrowthBlock {
  float profile[3];  ///< HairGrowth::lock_profile
  float unused = 0;
  uint32_t segments;    ///< per guide
  uint32_t bodies = 0;  ///< number of bodies whose penetration is resolved
  float clearance = 0;  ///< m, distance that hair keeps from bodies
  float zone = 0.15f;   ///< fraction of the length over which a hair closes in on one guide before a body
  std::array<CurlExample::Sample, CurlExample::kParts + 1> example{};
};
static_assert(sizeof(GrowthBlock) == 32 + 16 * 257);

/// Distributes hairs over the area between the guides' roots and chooses the guides that each follows. Guides
/// with fewer than 2 vertices, a vertex that is not finite, or no length get no hairs, nor do those with 0 in
/// `seeded` (per guide; empty = all 1). Deterministic; every hair has its own random stream, so a setting or
/// map changes only what it controls. Sorted by detailKey(), largest first.
std::vector<Hair> growHairs(const StrandSet& guides, const HairGrowth& growth,
                            std::span<const uint8_t> seeded = {});

}  // namespace strandcast
