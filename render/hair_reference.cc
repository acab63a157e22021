#include "render/hair_reference.h"

#include <algorithm>
#include <cmath>

#include "kernels/scalar_double.h"
#include "render/guide_nodes.h"

namespace strandcast {
namespace {

namespace f64 = kernels::f64;

f64::real3 lanes(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
Eigen::Vector3d vector(const f64::real3& v) { return {v.x, v.y, v.z}; }

f64::AcrossGuide exampleAt(const CurlExample& curl, const Hair& hair, double u) {
  const double place = u * CurlExample::kParts;
  const int part = std::min(static_cast<int>(place), CurlExample::kParts - 1);
  const auto &a = curl.samples[static_cast<size_t>(part)], &b = curl.samples[static_cast<size_t>(part + 1)];
  return f64::exampleAcross({a.x, a.y, 0}, {b.x, b.y, 0}, {a.slope_x, a.slope_y, 0},
                            {b.slope_x, b.slope_y, 0}, 1.0 / CurlExample::kParts, place - part,
                            hair.curl_phase, hair.example_scale);
}

}  // namespace

HairReference::HairReference(const StrandSet& rest_guides, std::span<const Vec3> positions, int segments)
    : segments_(segments),
      nodes_(rest_guides.strands() * (segments + 1),
             Node{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()}) {
  for (size_t g = 0; g < rest_guides.strands(); ++g) {
    const auto rest = rest_guides.strand(g);
    const size_t n = rest.size();
    if (n < 2) continue;
    std::vector<double> knots(n, 0);
    for (size_t i = 1; i < n; ++i) knots[i] = knots[i - 1] + (rest[i] - rest[i - 1]).cast<double>().norm();
    if (!(knots.back() > 0)) continue;
    for (double& k : knots) k /= knots[n - 1];
    const auto point = [&](size_t i) { return lanes(positions[rest_guides.offsets[g] + i].cast<double>()); };
    const auto tangent = [&](size_t i) {
      const size_t a = i == 0 ? 0 : i - 1, b = std::min(i + 1, n - 1);
      return (point(b) - point(a)) * (1 / std::max(knots[b] - knots[a], 1e-6));
    };
    f64::real3 normal = lanes(rootFrame(rest).normal.cast<double>());
    f64::real3 last_position = point(0), last_tangent = f64::normalizeOrZero(tangent(0));
    for (int i = 0; i <= segments; ++i) {
      const double u = static_cast<double>(i) / segments;
      const size_t above = std::upper_bound(knots.begin(), knots.end(), u) - knots.begin();
      const size_t k = std::min(above - 1, n - 2);
      const double h = std::max(knots[k + 1] - knots[k], 1e-6), s = std::clamp((u - knots[k]) / h, 0.0, 1.0);
      const f64::real3 position =
          f64::splinePosition(point(k), point(k + 1), tangent(k), tangent(k + 1), h, s);
      const f64::real3 derivative =
          f64::splineDerivative(point(k), point(k + 1), tangent(k), tangent(k + 1), h, s);
      const f64::real3 along = f64::normalizeOrZero(derivative);
      normal = f64::carriedNormal(normal, last_tangent, position - last_position, along);
      last_position = position;
      last_tangent = along;
      nodes_[g * (segments + 1) + i] = {vector(position), vector(derivative), vector(normal)};
    }
  }
}

HairReference::Vertex HairReference::at(const Hair& hair, const HairGrowth& growth, int wanted) const {
  const int node = std::min(wanted, static_cast<int>(std::ceil(hair.extent * static_cast<float>(segments_))));
  const double u = static_cast<double>(node) / segments_;
  const Node* of[3];
  for (int k = 0; k < 3; ++k) of[k] = &nodes_[hair.guides[k] * static_cast<size_t>(segments_ + 1) + node];
  const auto from = [&](int k, auto member) { return lanes(of[k]->*member - of[0]->*member); };
  const f64::real3 normal = lanes(of[0]->normal);
  const f64::real3 derivative = lanes(of[0]->derivative);
  const f64::real3 binormal = f64::cross(f64::normalizeOrZero(derivative), normal);
  const f64::Closing closing = f64::hairClosing(u, hair.clump, 0, 0);
  f64::AcrossGuide across = f64::hairAcross(
      u, {hair.offset[0], hair.offset[1], 0}, lanes(growth.lock_profile.cast<double>()), hair.tip_deviation,
      hair.whole_deviation, hair.deviation_phase, hair.curl_radius, hair.curl_turns, hair.curl_phase);
  across = f64::bothAcross(across, f64::besideGuide({hair.beside[0], hair.beside[1], 0}, closing));
  if (growth.curl_example) across = f64::bothAcross(across, exampleAt(*growth.curl_example, hair, u));
  const f64::real3 ab = from(1, &Node::position), ac = from(2, &Node::position);
  const f64::real3 position = f64::hairPosition(lanes(of[0]->position), ab, ac, hair.weights[0],
                                                hair.weights[1], closing, across, normal, binormal);
  const f64::real3 slope =
      f64::hairDerivative(derivative, from(1, &Node::derivative), from(2, &Node::derivative), ab, ac,
                          hair.weights[0], hair.weights[1], closing, across, normal, binormal);
  return {vector(position), vector(f64::normalizeOrZero(slope))};
}

double HairReference::guideLength(const Hair& hair) const {
  const Node* node = &nodes_[hair.guides[0] * static_cast<size_t>(segments_ + 1)];
  double length = 0;
  for (int i = 0; i < segments_; ++i) length += (node[i + 1].position - node[i].position).norm();
  return length;
}

}  // namespace strandcast
