#include "groom/bound_growth.h"

#include <algorithm>
#include <cmath>

#include "kernels/scalar_hair.h"

namespace strandcast {
namespace {

namespace f64 = kernels::f64;

constexpr float kFarthest = 1e6f;  // m, as GuideNodes::check()

f64::real3 toLanes(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
f64::quat toLanes(const Eigen::Quaterniond& q) { return {q.x(), q.y(), q.z(), q.w()}; }
Eigen::Vector3d fromLanes(const f64::real3& v) { return {v.x, v.y, v.z}; }
Eigen::Quaterniond fromLanes(const f64::quat& q) { return {q.w, q.x, q.y, q.z}; }

/// Arc length from the root as a fraction of the whole, per vertex; by index where there is no length.
/// Returns the length, m.
double knotsOf(std::span<const Vec3> points, std::vector<double>& knots) {
  knots.assign(points.size(), 0);
  for (size_t i = 1; i < points.size(); ++i)
    knots[i] = knots[i - 1] + (points[i] - points[i - 1]).cast<double>().norm();
  const double length = knots.back();
  for (size_t i = 1; i < points.size(); ++i)
    knots[i] =
        length > 0 ? knots[i] / length : static_cast<double>(i) / static_cast<double>(points.size() - 1);
  return length;
}

/// Points of the guide's curve at equal parts of its rest arc length.
std::vector<Eigen::Vector3d> nodesOf(std::span<const Vec3> points, const std::vector<double>& knots,
                                     int segments) {
  const size_t n = points.size();
  const auto point = [&](size_t i) { return toLanes(points[i].cast<double>()); };
  const auto slope = [&](size_t i) {
    const size_t a = i == 0 ? 0 : i - 1, b = std::min(i + 1, n - 1);
    return (point(b) - point(a)) * (1 / std::max(knots[b] - knots[a], 1e-6));
  };
  std::vector<Eigen::Vector3d> nodes;
  for (int i = 0; i <= segments; ++i) {
    const double u = static_cast<double>(i) / segments;
    const size_t above = std::upper_bound(knots.begin(), knots.end(), u) - knots.begin();
    const size_t k = std::min(above - 1, n - 2);
    const double h = std::max(knots[k + 1] - knots[k], 1e-6), s = std::clamp((u - knots[k]) / h, 0.0, 1.0);
    nodes.push_back(fromLanes(f64::splinePosition(point(k), point(k + 1), slope(k), slope(k + 1), h, s)));
  }
  return nodes;
}

/// Unit secants over an eighth of the nodes to both sides; zero where they have no length.
std::vector<f64::real3> secantsOf(const std::vector<Eigen::Vector3d>& nodes) {
  const auto last = static_cast<ptrdiff_t>(nodes.size()) - 1, reach = std::max<ptrdiff_t>(1, last / 8);
  std::vector<f64::real3> secants;
  for (ptrdiff_t i = 0; i <= last; ++i) {
    const auto low = static_cast<size_t>(std::max<ptrdiff_t>(i - reach, 0)),
               high = static_cast<size_t>(std::min(i + reach, last));
    secants.push_back(f64::normalizeOrZero(toLanes(nodes[high] - nodes[low])));
  }
  return secants;
}

bool isUsable(std::span<const Vec3> points) {
  return points.size() >= 2 && std::ranges::all_of(points, [](const Vec3& p) {
           return p.allFinite() && p.cwiseAbs().maxCoeff() < kFarthest;
         });
}

}  // namespace

BoundHairReference::BoundHairReference(const StrandSet& rest_guides, std::span<const Vec3> positions,
                                       std::span<const Pose> roots, int segments)
    : segments_(segments),
      lengths_(rest_guides.strands(), -1),
      nodes_(rest_guides.strands() * (static_cast<size_t>(segments) + 1)) {
  std::vector<double> knots;
  for (size_t g = 0; g < rest_guides.strands(); ++g) {
    const std::span<const Vec3> rest = rest_guides.strand(g),
                                now = positions.subspan(rest_guides.offsets[g], rest.size());
    if (!isUsable(rest) || !isUsable(now)) continue;
    lengths_[g] = knotsOf(rest, knots);
    const std::vector<Eigen::Vector3d> at_rest = nodesOf(rest, knots, segments);
    std::vector<Eigen::Vector3d> at_present = nodesOf(now, knots, segments);
    f64::quat rotation = f64::normalizeQuat(toLanes(roots[g].rotation.cast<double>()));
    const f64::real3 moved = toLanes(roots[g].position.cast<double>());
    const auto carried = [&](size_t i) {
      return f64::carriedPoint(moved, rotation, {0, 0, 0}, toLanes(at_rest[i]));
    };
    double farthest = 0;
    for (size_t i = 0; i < at_rest.size(); ++i)
      farthest = std::max(farthest, (at_present[i] - fromLanes(carried(i))).norm());
    const double share = f64::motionShare(farthest);
    for (size_t i = 0; i < at_rest.size(); ++i)
      at_present[i] = fromLanes(f64::settledNode(toLanes(at_present[i]), carried(i), share));
    const std::vector<f64::real3> rest_tangents = secantsOf(at_rest), tangents = secantsOf(at_present);
    Node* const nodes = &nodes_[g * (static_cast<size_t>(segments) + 1)];
    for (size_t i = 0; i < at_rest.size(); ++i) {
      // The root's rotation stays as given: a clamped root bends behind its frame.
      if (i > 0) rotation = f64::nodeRotation(rotation, rest_tangents[i], tangents[i]);
      nodes[i] = {at_rest[i], at_present[i], fromLanes(rotation)};
    }
  }
}

std::vector<BoundHairReference::Vertex> BoundHairReference::grow(std::span<const Vec3> rest,
                                                                 const HairBinding& binding) const {
  for (size_t k = 0; k < 3; ++k)
    if (binding.weight(k) > 0 && lengths_[binding.guides[k]] < 0) return {};
  std::vector<double> knots;
  const double length = knotsOf(rest, knots);
  std::vector<Vertex> vertices;
  for (size_t j = 0; j < rest.size(); ++j) {
    const f64::real3 x = toLanes(rest[j].cast<double>());
    const f64::real3 along = f64::normalizeOrZero(
        toLanes((rest[std::min(j + 1, rest.size() - 1)] - rest[j == 0 ? 0 : j - 1]).cast<double>()));
    Eigen::Vector3d position = Eigen::Vector3d::Zero(), tangent = Eigen::Vector3d::Zero();
    for (size_t k = 0; k < 3; ++k) {
      const double weight = binding.weight(k), guide_length = lengths_[binding.guides[k]];
      if (weight == 0) continue;
      const double u = f64::placeOnGuide(knots[j], length, guide_length);
      const int i = std::min(static_cast<int>(u * segments_), segments_ - 1);
      const double f = u * segments_ - i;
      const Node* const nodes =
          &nodes_[binding.guides[k] * (static_cast<size_t>(segments_) + 1) + static_cast<size_t>(i)];
      for (int end = 0; end < 2; ++end) {
        const Node& node = nodes[end];
        const double share = weight * (end == 0 ? 1 - f : f);
        const f64::quat rotation = toLanes(node.rotation);
        position +=
            share * fromLanes(f64::carriedPoint(toLanes(node.position), rotation, toLanes(node.rest), x));
        tangent += share * fromLanes(f64::rotate(rotation, along));
      }
    }
    vertices.push_back({position, fromLanes(f64::normalizeOrZero(toLanes(tangent)))});
  }
  return vertices;
}

}  // namespace strandcast
