#include "render/curl_example.h"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/error.h"
#include "io/groom_file.h"
#include "kernels/scalar_double.h"

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

}  // namespace strandcast
