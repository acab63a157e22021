#include "collision/body_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace strandcast {

std::vector<SurfaceSample> sampleSurface(const TriangleMesh& mesh, size_t count) {
  std::vector<double> cumulative;
  double area = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3 &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
    area += 0.5 * static_cast<double>((b - a).cross(c - a).norm());
    cumulative.push_back(area);
  }
  std::vector<SurfaceSample> samples;
  if (!(area > 0)) return samples;
  size_t triangle = 0;
  for (size_t i = 0; i < count; ++i) {
    const double target = area * (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    while (cumulative[triangle] < target && triangle + 1 < cumulative.size()) ++triangle;
    const auto& t = mesh.triangles[triangle];
    const Vec3 &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
    const double turn = 0.7548776662466927 * static_cast<double>(i + 1);
    const double other = 0.5698402909980532 * static_cast<double>(i + 1);
    const float u = std::sqrt(static_cast<float>(turn - std::floor(turn)));
    const float v = static_cast<float>(other - std::floor(other));
    const Vec3 normal = (b - a).cross(c - a);
    if (normal.norm() <= 0) continue;
    samples.push_back({a * (1 - u) + b * (u * (1 - v)) + c * (u * v), normal.normalized()});
  }
  return samples;
}

double uncertainShare(const TriangleMesh& mesh, const MeshQuery& query, float step) {
  constexpr size_t kSamples = 2000;
  const std::vector<SurfaceSample> samples = sampleSurface(mesh, kSamples);
  const auto isDoubtful = [&](const Vec3& place) {
    return std::fabs(std::fabs(query.windingNumber(place)) - 0.5f) < 0.25f;
  };
  const auto doubtful = std::count_if(samples.begin(), samples.end(), [&](const SurfaceSample& sample) {
    return isDoubtful(sample.position + step * sample.normal) ||
           isDoubtful(sample.position - step * sample.normal);
  });
  return samples.empty() ? 0 : static_cast<double>(doubtful) / static_cast<double>(samples.size());
}

namespace {

using Corners = std::array<Vec3, 3>;

float longestEdge(const Corners& t) {
  return std::max({(t[1] - t[0]).norm(), (t[2] - t[1]).norm(), (t[0] - t[2]).norm()});
}

class TriangleCutter {
 public:
  TriangleCutter(const MeshQuery& query, const Corners& triangle, float resolution,
                 const std::atomic<bool>& stop)
      : query_(query), resolution_(resolution), stop_(stop) {
    const Vec3 normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
    const float length = normal.norm();
    if (length > 0) step_ = normal * (kAway * resolution / length);
  }

  void cut(const Corners& t, std::vector<Corners>& out) const {
    if (stop_) return;
    const float edge = longestEdge(t);
    const bool small = edge <= resolution_;
    // A large triangle is sampled on a lattice no coarser than the resolution, up to a size at which cutting
    // is cheaper.
    const int divisions = std::clamp(static_cast<int>(std::ceil(edge / resolution_)), 1, kMaxDivisions);
    int places = 0, outside = 0;
    for (int i = 0; i <= divisions; ++i)
      for (int j = 0; i + j <= divisions; ++j) {
        ++places;
        outside += boundsOutside(query_, latticePlace(t, i, j, divisions), step_) ? 1 : 0;
        if (small && outside > 0) return out.push_back(t);
      }
    if (outside == places) return out.push_back(t);
    const bool seen_enough = edge <= kMaxDivisions * resolution_;
    if (outside == 0 && seen_enough) return;
    const Vec3 ab = 0.5f * (t[0] + t[1]), bc = 0.5f * (t[1] + t[2]), ca = 0.5f * (t[2] + t[0]);
    for (const Corners& part :
         {Corners{t[0], ab, ca}, Corners{t[1], bc, ab}, Corners{t[2], ca, bc}, Corners{ab, bc, ca}})
      cut(part, out);
  }

 private:
  static constexpr int kMaxDivisions = 8;
  // Offset from the surface of the tested points, as a share of the resolution.
  static constexpr float kAway = 0.02f;
  // Contraction towards the centroid, to keep tested points off the edges.
  static constexpr float kWithin = 0.95f;

  static Vec3 latticePlace(const Corners& t, int i, int j, int divisions) {
    const Vec3 centre = (t[0] + t[1] + t[2]) / 3;
    const Vec3 place =
        t[0] + (static_cast<float>(i) * (t[1] - t[0]) + static_cast<float>(j) * (t[2] - t[0])) /
                   static_cast<float>(divisions);
    return centre + kWithin * (place - centre);
  }

  const MeshQuery& query_;
  float resolution_;
  const std::atomic<bool>& stop_;
  Vec3 step_ = Vec3::Zero();
};

}  // namespace

bool isInside(const MeshQuery& query, const Vec3& point) {
  return std::fabs(query.windingNumber(point)) > 0.5f;
}

bool boundsOutside(const MeshQuery& query, const Vec3& place, const Vec3& step) {
  return !isInside(query, place + step) || !isInside(query, place - step);
}

std::vector<Corners> outerPieces(const MeshQuery& query, const Corners& triangle, float resolution,
                                 const std::atomic<bool>& stop) {
  std::vector<Corners> out;
  TriangleCutter(query, triangle, resolution, stop).cut(triangle, out);
  return out;
}

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
double maxSlope(const std::vector<OpenEdge>& edges, const Vec3& centre, float radius) {
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
  const double winding = whole_.windingNumber(centre), slope = maxSlope(open_edges_, centre, radius);
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
