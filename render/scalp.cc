#include "render/scalp.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "groom/neighbors.h"
#include "io/image.h"

namespace strandcast {

float ScalpMap::at(const Vec2& place) const {
  const float x = (place.x() - std::floor(place.x())) * static_cast<float>(width) - 0.5f;
  const float y =
      std::clamp(place.y() * static_cast<float>(height) - 0.5f, 0.0f, static_cast<float>(height - 1));
  const int left = static_cast<int>(std::floor(x)), top = std::min(static_cast<int>(y), height - 1);
  const float right_part = x - static_cast<float>(left), bottom_part = y - static_cast<float>(top);
  const auto value = [&](int i, int j) {
    return values[static_cast<size_t>(std::min(j, height - 1)) * width + (i + width) % width];
  };
  const auto row = [&](int j) { return std::lerp(value(left, j), value(left + 1, j), right_part); };
  return std::lerp(row(top), row(top + 1), bottom_part);
}

ScalpMap readScalpMap(const std::filesystem::path& file) {
  const Image image = readPng(file);
  ScalpMap map{image.width, image.height, {}};
  map.values.reserve(image.rgb.size() / 3);
  for (size_t i = 0; i < image.rgb.size(); i += 3)
    map.values.push_back(static_cast<float>(image.rgb[i] + image.rgb[i + 1] + image.rgb[i + 2]) / 765.0f);
  return map;
}

ScalpPlaces::ScalpPlaces(const StrandSet& guides) : guides_(guides) {
  Box roots;
  for (size_t g = 0; g < guides.strands(); ++g)
    if (guides.verticesOf(g) > 0 && guides.strand(g).front().allFinite())
      roots.extend(Eigen::Vector3f(guides.strand(g).front()));
  if (!roots.isEmpty()) middle_ = roots.center();
}

Vec2 ScalpPlaces::of(const uint32_t (&guides)[3], const float (&weights)[2]) const {
  if (guides_.uvs.size() == guides_.strands()) {
    const Vec2& first = guides_.uvs[guides[0]];
    Vec2 place = first;
    for (int k = 0; k < 2; ++k) place += weights[k] * (guides_.uvs[guides[k + 1]] - first);
    return place;
  }
  const Vec3& first = guides_.strand(guides[0]).front();
  Vec3 out = first - middle_;
  for (int k = 0; k < 2; ++k) out += weights[k] * (guides_.strand(guides[k + 1]).front() - first);
  const float turn = std::atan2(out.x(), out.z()) / (2 * std::numbers::pi_v<float>);
  const float height = out.y() / std::max(out.norm(), 1e-9f);
  return {0.5f + turn, 0.5f - std::asin(std::clamp(height, -1.0f, 1.0f)) / std::numbers::pi_v<float>};
}

namespace {

constexpr size_t kNeighbors = 8;
constexpr float kMaxGap = 2.1f;   // rad, between neighbours in one triangle
constexpr float kMaxEdge = 3.5f;  // in median spacings

/// Sorts neighbours by their angle around `center` in their least squares plane.
void sortByAngle(const std::vector<Vec3>& roots, uint32_t center, std::vector<uint32_t>& neighbors,
                 std::vector<float>& angles) {
  Eigen::Matrix3f spread = Eigen::Matrix3f::Zero();
  for (uint32_t n : neighbors) {
    const Eigen::Vector3f d = roots[n] - roots[center];
    spread += d * d.transpose() / std::max(d.squaredNorm(), 1e-20f);
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> axes;
  axes.computeDirect(spread);
  const Eigen::Vector3f x = axes.eigenvectors().col(2), y = axes.eigenvectors().col(1);
  std::vector<std::pair<float, uint32_t>> sorted;
  for (uint32_t n : neighbors) {
    const Eigen::Vector3f d = roots[n] - roots[center];
    sorted.emplace_back(std::atan2(d.dot(y), d.dot(x)), n);
  }
  std::sort(sorted.begin(), sorted.end());
  neighbors.clear();
  angles.clear();
  for (const auto& [angle, n] : sorted) {
    neighbors.push_back(n);
    angles.push_back(angle);
  }
}

float triangleArea(const Vec3& a, const Vec3& b, const Vec3& c) { return 0.5f * (b - a).cross(c - a).norm(); }

}  // namespace

std::vector<RootTriangle> rootTriangles(const StrandSet& guides, const std::vector<uint8_t>& usable) {
  std::vector<Vec3> roots(guides.strands(), Vec3::Zero());
  std::vector<StrandCourse> courses(guides.strands());
  std::vector<uint32_t> members;
  for (uint32_t g = 0; g < guides.strands(); ++g) {
    if (usable[g] == 0) continue;
    roots[g] = guides.strand(g).front();
    courses[g] = courseOf(guides.strand(g));
    members.push_back(g);
  }
  std::vector<RootTriangle> triangles;
  if (members.size() < 3) return triangles;
  const RootTree tree(roots, members);
  std::vector<std::vector<uint32_t>> neighbors;
  std::vector<float> spacing;
  for (uint32_t g : members) {
    neighbors.push_back(tree.nearest(roots[g], kNeighbors, g));
    spacing.push_back(
        (roots[neighbors.back()[std::min<size_t>(2, neighbors.back().size() - 1)]] - roots[g]).norm());
  }
  std::vector<float> ordered = spacing;
  std::nth_element(ordered.begin(), ordered.begin() + ordered.size() / 2, ordered.end());
  const float longest = kMaxEdge * ordered[ordered.size() / 2];

  std::vector<float> angles;
  for (size_t m = 0; m < members.size(); ++m) {
    const uint32_t g = members[m];
    std::vector<uint32_t>& around = neighbors[m];
    sortByAngle(roots, g, around, angles);
    for (size_t i = 0; i < around.size(); ++i) {
      const size_t j = (i + 1) % around.size();
      const uint32_t a = around[i], b = around[j];
      float gap = angles[j] - angles[i];
      if (gap <= 0) gap += 2 * std::numbers::pi_v<float>;
      if (a == b || gap > kMaxGap) continue;
      const bool parted = isParting(courses[g], courses[a]) || isParting(courses[g], courses[b]) ||
                          isParting(courses[a], courses[b]);
      const float edge = std::max(
          {(roots[a] - roots[g]).norm(), (roots[b] - roots[g]).norm(), (roots[a] - roots[b]).norm()});
      const float area = triangleArea(roots[g], roots[a], roots[b]);
      if (edge > longest || !(area > 1e-6f * edge * edge)) continue;
      triangles.push_back({{g, a, b}, area, parted});
    }
  }
  return triangles;
}

}  // namespace strandcast
