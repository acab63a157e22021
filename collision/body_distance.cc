#include "collision/body_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace strandcast {
namespace {

using Point = Eigen::Vector3d;

/// Magnitude of the winding number's gradient, 1/m: the Biot-Savart integral over straight edges.
double windingSlope(const std::vector<OpenEdge>& edges, const Vec3& point) {
  Point sum = Point::Zero();
  for (const OpenEdge& edge : edges) {
    const Point a = (edge.from - point).cast<double>(), b = (edge.to - point).cast<double>();
    const double la = a.norm(), lb = b.norm(), ends = la * lb, apart = ends + a.dot(b);
    if (ends * apart > 0) sum += a.cross(b) * (static_cast<double>(edge.excess) * (la + lb) / (ends * apart));
  }
  return sum.norm() / (4 * std::numbers::pi);
}

/// Upper bound of windingSlope() in a ball: the slope at its centre plus the most that it can change.
double mostSlope(const std::vector<OpenEdge>& edges, const Vec3& centre, float radius) {
  double change = 0;
  for (const OpenEdge& edge : edges) {
    const Vec3 along = edge.to - edge.from;
    const float squared = along.squaredNorm();
    const float part = squared > 0 ? std::clamp((centre - edge.from).dot(along) / squared, 0.0f, 1.0f) : 0.0f;
    const double away = double{(edge.from + part * along - centre).norm()} - double{radius};
    if (away <= 0) return std::numeric_limits<double>::infinity();
    change += static_cast<double>(edge.excess * std::sqrt(squared)) / (away * away * away);
  }
  return windingSlope(edges, centre) + change * double{radius} / (2 * std::numbers::pi);
}

// Distance of the winding number from a half up to which a lid may be nearer than the mesh. Farther from a
// half, around the rim of a hole, where the number changes by 1 in a full turn, the mesh is nearer. Around a
// rim that lies inside there is no lid.
constexpr double kLidWithin = 0.35;

}  // namespace

BodyPoint BodyDistance::at(const Vec3& point, float distance) const {
  const double winding = std::fabs(double{whole_.windingNumber(point)}), to_half = std::fabs(winding - 0.5);
  BodyPoint out;
  out.in_doubt = std::fabs(winding - std::round(winding)) > 0.25;
  if (!open_edges_.empty() && to_half < kLidWithin) {
    const double to_lid = to_half / std::max(windingSlope(open_edges_, point), 1e-12);
    out.to_lid = to_lid < double{distance};
    if (out.to_lid) distance = static_cast<float>(to_lid);
  }
  out.signed_distance = winding > 0.5 ? -distance : distance;
  return out;
}

bool BodyDistance::clearOfLids(const Vec3& centre, float radius) const {
  if (open_edges_.empty()) return true;
  // Through the mesh the number changes by integers, elsewhere by no more than the slope allows.
  const double winding = whole_.windingNumber(centre), slope = mostSlope(open_edges_, centre, radius);
  const double to_half = std::fabs(winding - std::floor(winding) - 0.5) - slope * double{radius};
  // Bound of the distance to the mesh from any point of the ball.
  const double reach = double{outer_.distance(centre)} + double{radius};
  constexpr double kSeriesError = 0.01;
  return to_half - kSeriesError > std::min(kLidWithin, slope * reach);
}

float DistanceWalk::start(const Vec3& place, bool clear_of_lids) {
  clear_of_lids_ = clear_of_lids;
  to_mesh_ = body_.toMesh(place, std::numeric_limits<float>::infinity());
  return signed_ = body_.at(place, to_mesh_).signed_distance;
}

float DistanceWalk::next(const Vec3& place, float step) {
  // Rounding: a cell may be only a hundred float roundings of the coordinates.
  const float reach = 1.02f * step;
  const float before = to_mesh_;
  to_mesh_ = body_.toMesh(place, before + reach);
  if (clear_of_lids_ && std::max(before, to_mesh_) > reach) return signed_ = std::copysign(to_mesh_, signed_);
  return signed_ = body_.at(place, to_mesh_).signed_distance;
}

}  // namespace strandcast
