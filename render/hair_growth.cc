#include "render/hair_growth.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/hash.h"
#include "render/hair_detail.h"
#include "render/root_triangles.h"

namespace strandcast {
namespace {

constexpr float kMinImportance = 0.02f;

class RandomStream {
 public:
  explicit RandomStream(uint64_t seed) : state_(seed) {}
  float uniform() {  ///< [0, 1)
    const uint64_t bits = splitMix64(state_);
    state_ += kSplitMixStep;
    return static_cast<float>(bits >> 40) * 0x1p-24f;
  }
  float between(float low, float high) { return low + (high - low) * uniform(); }

 private:
  uint64_t state_;
};

std::vector<uint8_t> usableGuides(const StrandSet& guides) {
  std::vector<uint8_t> usable(guides.strands(), 0);
  for (size_t g = 0; g < guides.strands(); ++g) {
    const auto points = guides.strand(g);
    if (points.size() < 2) continue;
    const bool finite =
        std::all_of(points.begin(), points.end(), [](const Vec3& p) { return p.allFinite(); });
    const float length = finite ? arcLength(points) : 0;
    usable[g] = std::isfinite(length) && length > 0;
  }
  return usable;
}

/// An area where hair grows: between three guides, or around a single one that is in no triangle.
struct Plot {
  RootTriangle triangle;
  bool lone;
};

std::vector<Plot> plots(const StrandSet& guides, float clump_radius) {
  const std::vector<uint8_t> usable = usableGuides(guides);
  std::vector<uint8_t> covered(guides.strands(), 0);
  std::vector<Plot> found;
  for (const RootTriangle& triangle : rootTriangles(guides, usable)) {
    for (uint32_t g : triangle.guides) covered[g] = 1;
    found.push_back({triangle, false});
  }
  // Three times the disc, because inner triangles appear three times, too.
  const float disc = 3 * std::numbers::pi_v<float> * clump_radius * clump_radius;
  for (uint32_t g = 0; g < guides.strands(); ++g)
    if (usable[g] != 0 && covered[g] == 0)
      found.push_back({{{g, g, g}, std::max(disc, 1e-12f), false}, true});
  return found;
}

void placeBetween(Hair& hair, const RootTriangle& triangle, RandomStream& random) {
  const float s = std::sqrt(random.uniform()), t = random.uniform();
  float weights[3] = {1 - s, s * (1 - t), s * t};
  const int nearest = static_cast<int>(std::max_element(weights, weights + 3) - weights);
  for (int k = 0; k < 3; ++k) {
    hair.guides[k] = triangle.guides[(nearest + k) % 3];
    if (k > 0) hair.weights[k - 1] = weights[(nearest + k) % 3];
  }
}

void followOne(Hair& hair) {
  hair.guides[1] = hair.guides[2] = hair.guides[0];
  hair.weights[0] = hair.weights[1] = 0;
}

void setOffset(Hair& hair, float radius, RandomStream& random) {
  const float r = radius * std::sqrt(random.uniform());
  const float angle = random.between(0, 2 * std::numbers::pi_v<float>);
  hair.offset[0] = r * std::cos(angle);
  hair.offset[1] = r * std::sin(angle);
}

/// For guides that part: the hair keeps its root, as an offset in the nearest guide's frame, and follows that
/// guide alone. Its clump closes the offset towards the tip. The component along the guide is dropped,
/// because it would only slide the hair along itself.
void placeBeside(Hair& hair, const StrandSet& guides) {
  const auto points = guides.strand(hair.guides[0]);
  Vec3 from_guide = Vec3::Zero();
  for (int k = 0; k < 2; ++k)
    from_guide += hair.weights[k] * (guides.strand(hair.guides[k + 1]).front() - points.front());
  const RootFrame frame = rootFrame(points);
  followOne(hair);
  hair.beside[0] = from_guide.dot(frame.normal);
  hair.beside[1] = from_guide.dot(frame.binormal);
}

/// Equal for all hairs that follow the same guide 0, so that locks differ from each other but stay coherent.
RandomStream lockStream(uint32_t guide, uint64_t seed) {
  return RandomStream(seed ^ (guide * 0x2545f4914f6cdd1du));
}

void setCurl(Hair& hair, const StrandSet& guides, const HairGrowth& growth, RandomStream& random,
             RandomStream& lock) {
  const float length = arcLength(guides.strand(hair.guides[0]));
  const float size = lock.between(0.6f, 1.1f) * random.between(0.8f, 1.1f);
  hair.curl_radius = growth.curl_radius * size;
  hair.example_scale = growth.curl_example ? length * size : 0;
  hair.curl_turns =
      length / std::max(growth.curl_pitch, 1e-3f) * lock.between(0.85f, 1.15f) * random.between(0.97f, 1.03f);
  hair.curl_phase = lock.uniform() + random.between(-0.1f, 0.1f);
}

/// Every hair draws the same number of random values in the same order, so that a setting changes only what
/// it controls.
Hair growOne(const Plot& plot, const StrandSet& guides, const HairGrowth& growth, RandomStream& random) {
  const bool combined = growth.interpolation == Interpolation::kCombined;
  Hair hair{};
  placeBetween(hair, plot.triangle, random);
  const float clump = random.uniform();
  const bool in_lock = random.uniform() < growth.single_strand_part;
  const bool single =
      plot.lone || growth.interpolation == Interpolation::kSingleStrand || (combined && in_lock);
  if (single) followOne(hair);
  hair.clump = combined && !single ? growth.clump * clump * (2 - clump) : 0;
  setOffset(hair, single ? growth.clump_radius : 0.25f * growth.clump_radius, random);
  if (plot.triangle.parted && !single) placeBeside(hair, guides);
  const float shortness = random.uniform();
  hair.extent = 1 - 0.22f * shortness * shortness;
  hair.width = random.between(0.75f, 1.25f);
  const bool tip = random.uniform() < growth.tip_deviation_part;
  const bool whole = random.uniform() < growth.whole_deviation_part;
  const float far = random.between(0.3f, 1.0f);
  hair.tip_deviation = tip ? growth.tip_deviation * far : 0;
  hair.whole_deviation = whole ? growth.whole_deviation * far : 0;
  hair.deviation_phase = random.uniform();
  RandomStream lock = lockStream(hair.guides[0], growth.seed);
  hair.shade = 0.65f * random.between(-1, 1) + 0.35f * lock.between(-1, 1);
  hair.warmth = random.between(-1, 1);
  setCurl(hair, guides, growth, random, lock);
  hair.first_sample = random.uniform();
  return hair;
}

}  // namespace

RootFrame rootFrame(std::span<const Vec3> points) {
  Vec3 tangent = points.size() > 1 ? Vec3(points[1] - points[0]) : Vec3(Vec3::UnitY());
  if (!tangent.allFinite() || tangent.norm() < 1e-9f) tangent = Vec3::UnitY();
  tangent.normalize();
  const Vec3 normal = tangent.unitOrthogonal();
  return {normal, tangent.cross(normal)};
}

std::vector<Hair> growHairs(const StrandSet& guides, const HairGrowth& growth) {
  std::vector<Hair> hairs;
  const std::vector<Plot> ground = plots(guides, growth.clump_radius);
  if (ground.empty()) return hairs;
  std::vector<double> area_up_to;
  double mean = 0;
  for (const Plot& plot : ground) mean += plot.triangle.area / static_cast<double>(ground.size());
  // Half by area, for an even scalp; half by guide, because a lock that springs from one spot (a ponytail)
  // has many guides on a small area.
  double area = 0;
  for (const Plot& plot : ground) area_up_to.push_back(area += 0.5 * (plot.triangle.area + mean));

  RandomStream shared(growth.seed);
  const double golden = std::numbers::phi - 1;
  const double dither_start = shared.uniform();
  const ScalpPlaces scalp(guides);
  hairs.reserve(growth.hairs);
  for (size_t i = 0; i < growth.hairs; ++i) {
    RandomStream random(growth.seed * 0xd1342543de82ef95u + (i + 1) * 0xaf251af3b0f025b5u);
    // Stratified over the area; the golden ratio sequence spreads dither evenly among neighbouring hairs.
    const double at = area * (static_cast<double>(i) + random.uniform()) / static_cast<double>(growth.hairs);
    const size_t plot = std::upper_bound(area_up_to.begin(), area_up_to.end(), at) - area_up_to.begin();
    const float kept = random.uniform();
    Hair hair = growOne(ground[std::min(plot, ground.size() - 1)], guides, growth, random);
    const double turns = dither_start + golden * static_cast<double>(i);
    hair.dither = std::min(static_cast<float>(turns - std::floor(turns)), 1 - 0x1p-24f);
    const Vec2 place = scalp.of(hair.guides, hair.weights);
    hair.importance = growth.importance ? std::max(growth.importance->at(place), kMinImportance) : 1;
    if (growth.thickness) hair.width *= growth.thickness->at(place);
    const bool grows = !growth.density || kept < growth.density->at(place);
    if (grows && hair.width > 0) hairs.push_back(hair);
  }
  std::stable_sort(hairs.begin(), hairs.end(),
                   [](const Hair& a, const Hair& b) { return detailKey(a) > detailKey(b); });
  return hairs;
}

}  // namespace strandcast
