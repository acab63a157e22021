#include "render/hair_growth.h"

#include <fmt/format.h>
#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/error.h"
#include "core/hash.h"
#include "io/groom_file.h"
#include "kernels/scalar_hair.h"
#include "render/hair_selection.h"
#include "render/scalp.h"

namespace strandcast {
namespace {

namespace f64 = kernels::f64;
using Vec = Eigen::Vector3d;

constexpr size_t kMinVertices = 5;  // with fewer, a cubic interpolates all vertices

f64::real3 lanes(const Vec& v) { return {v.x(), v.y(), v.z()}; }
Vec vector(const f64::real3& v) { return {v.x, v.y, v.z}; }

/// Samples a smooth curve through the vertices at equal parts of its length, the spline of
/// render/guide_nodes.h.
std::vector<Vec> resampled(std::span<const Vec3> strand, int parts) {
  const size_t n = strand.size();
  std::vector<double> knots(n, 0);
  for (size_t i = 1; i < n; ++i)
    knots[i] = knots[i - 1] + std::max((strand[i] - strand[i - 1]).cast<double>().norm(), 1e-12);
  for (double& k : knots) k /= knots[n - 1];
  const auto point = [&](size_t i) { return lanes(strand[i].cast<double>()); };
  const auto tangent = [&](size_t i) {
    const size_t a = i == 0 ? 0 : i - 1, b = std::min(i + 1, n - 1);
    return (point(b) - point(a)) * (1 / (knots[b] - knots[a]));
  };
  std::vector<Vec> points;
  size_t k = 0;
  for (int i = 0; i <= parts; ++i) {
    const double u = static_cast<double>(i) / parts;
    while (k + 2 < n && knots[k + 1] <= u) ++k;
    const double h = knots[k + 1] - knots[k];
    points.push_back(vector(
        f64::splinePosition(point(k), point(k + 1), tangent(k), tangent(k + 1), h, (u - knots[k]) / h)));
  }
  return points;
}

/// Coefficients of u, u^2 and u^3: root + coefficients * (u, u^2, u^3) is the axis.
Eigen::Matrix3d axisThrough(const std::vector<Vec>& points) {
  const auto n = static_cast<Eigen::Index>(points.size());
  Eigen::MatrixX3d powers(n, 3), offsets(n, 3);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double u = static_cast<double>(i) / static_cast<double>(n - 1);
    powers.row(i) << u, u * u, u * u * u;
    offsets.row(i) = (points[static_cast<size_t>(i)] - points[0]).transpose();
  }
  return powers.colPivHouseholderQr().solve(offsets).transpose();
}

/// Absolute turns about (0, 0), skipping samples near it, which have no reliable direction.
float turnsOf(const CurlExample& curl) {
  double turns = 0, last = 0;
  bool any = false;
  for (const CurlExample::Sample& s : curl.samples) {
    if (std::hypot(s.x, s.y) < 0.1f * curl.reach) continue;
    const double angle = std::atan2(s.y, s.x) / (2 * std::numbers::pi);
    if (any) turns += std::abs(angle - last - std::round(angle - last));
    last = angle;
    any = true;
  }
  return static_cast<float>(turns);
}

}  // namespace

CurlExample curlOf(std::span<const Vec3> strand, const std::string& where) {
  if (strand.size() < kMinVertices)
    throw Error("a strand is too short to take a curl from",
                fmt::format("{} has {} vertices", where, strand.size()),
                fmt::format("name one of {} or more", kMinVertices));
  for (const Vec3& p : strand)
    if (!p.allFinite()) throw Error("a strand's vertex is not finite", where, "name another strand");
  float length = 0;
  for (size_t i = 1; i < strand.size(); ++i) length += (strand[i] - strand[i - 1]).norm();
  if (!(length > 0) || !std::isfinite(length))
    throw Error("a strand without length has no curl", where, "name another strand");

  constexpr int kParts = CurlExample::kParts;
  const std::vector<Vec> points = resampled(strand, kParts);
  const Eigen::Matrix3d axis = axisThrough(points);
  const auto at = [&](double u) { return Vec(points[0] + axis * Vec(u, u * u, u * u * u)); };
  const auto tangentAt = [&](double u) { return Vec(axis * Vec(1, 2 * u, 3 * u * u)).normalized(); };
  std::vector<double> run{0};  // arc length of the axis
  for (int i = 1; i <= kParts; ++i)
    run.push_back(run.back() + (at(static_cast<double>(i) / kParts) - at((i - 1.0) / kParts)).norm());
  const double axis_length = run.back();
  if (!(axis_length > 1e-3 * static_cast<double>(length)))
    throw Error("a strand goes nowhere, so it has no axis to take a curl from", where, "name another strand");

  Vec tangent = tangentAt(0), normal = tangent.unitOrthogonal();
  std::vector<Eigen::Vector2d> offsets;
  std::vector<double> along;  // position along the axis; made monotonic where the strand turns back
  for (int i = 0; i <= kParts; ++i) {
    const double u = static_cast<double>(i) / kParts;
    if (i > 0) {
      const Vec step = at(u) - at(u - 1.0 / kParts), now = tangentAt(u);
      normal = vector(f64::carriedNormal(lanes(normal), lanes(tangent), lanes(step), lanes(now)));
      tangent = now;
    }
    const Vec off = points[static_cast<size_t>(i)] - at(u);
    offsets.emplace_back(off.dot(normal) / axis_length, off.dot(tangent.cross(normal)) / axis_length);
    const double place = run[static_cast<size_t>(i)] + off.dot(tangent);
    along.push_back(i == 0 ? 0 : std::clamp(place, along.back(), axis_length));
  }
  along.back() = axis_length;

  CurlExample curl{};
  curl.axis_length = static_cast<float>(axis_length);
  for (size_t i = 0, k = 0; i <= kParts; ++i) {  // resamples from parts of the strand to parts of the axis
    const double wanted = axis_length * static_cast<double>(i) / kParts;
    while (k + 2 < along.size() && along[k + 1] <= wanted) ++k;
    const double part = std::clamp((wanted - along[k]) / std::max(along[k + 1] - along[k], 1e-15), 0.0, 1.0);
    const Eigen::Vector2f place = (offsets[k] + part * (offsets[k + 1] - offsets[k])).cast<float>();
    curl.samples[i] = {place.x(), place.y(), 0, 0};
    curl.reach = std::max(curl.reach, place.norm());
  }
  for (int i = 0; i <= kParts; ++i) {
    const int a = std::max(i - 1, 0), b = std::min(i + 1, kParts);
    const auto &before = curl.samples[static_cast<size_t>(a)], &after = curl.samples[static_cast<size_t>(b)];
    const float per_u = static_cast<float>(kParts) / static_cast<float>(b - a);
    curl.samples[static_cast<size_t>(i)].slope_x = (after.x - before.x) * per_u;
    curl.samples[static_cast<size_t>(i)].slope_y = (after.y - before.y) * per_u;
  }
  curl.turns = turnsOf(curl);
  return curl;
}

CurlExample readCurlExample(const std::filesystem::path& file, size_t strand) {
  const StrandSet strands = readRawGroom(file).strands;
  if (strand >= strands.strands())
    throw Error(fmt::format("there is no strand {}", strand),
                fmt::format("{} has {} strands", file.string(), strands.strands()),
                fmt::format("name one from 0 to {}", strands.strands() - 1));
  return curlOf(strands.strand(strand), fmt::format("strand {} of {}", strand, file.string()));
}

namespace {

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

std::vector<uint8_t> usableGuides(const StrandSet& guides, std::span<const uint8_t> seeded) {
  std::vector<uint8_t> usable(guides.strands(), 0);
  for (size_t g = 0; g < guides.strands(); ++g) {
    const auto points = guides.strand(g);
    if (points.size() < 2 || (!seeded.empty() && seeded[g] == 0)) continue;
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

std::vector<Plot> plots(const StrandSet& guides, float clump_radius, std::span<const uint8_t> seeded) {
  const std::vector<uint8_t> usable = usableGuides(guides, seeded);
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

std::vector<Hair> growHairs(const StrandSet& guides, const HairGrowth& growth,
                            std::span<const uint8_t> seeded) {
  std::vector<Hair> hairs;
  const std::vector<Plot> ground = plots(guides, growth.clump_radius, seeded);
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
    hair.importance = growth.importance ? std::max(growth.importance->at(place), kLeastImportance) : 1;
    if (growth.thickness) hair.width *= growth.thickness->at(place);
    const bool grows = !growth.density || kept < growth.density->at(place);
    if (grows && hair.width > 0) hairs.push_back(hair);
  }
  std::stable_sort(hairs.begin(), hairs.end(),
                   [](const Hair& a, const Hair& b) { return detailKey(a) > detailKey(b); });
  return hairs;
}

}  // namespace strandcast
