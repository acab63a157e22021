#include "collision/outer_surface.h"

#include <algorithm>
#include <cmath>

namespace strandcast {
namespace {

using Corners = std::array<Vec3, 3>;

float longestEdge(const Corners& t) {
  return std::max({(t[1] - t[0]).norm(), (t[2] - t[1]).norm(), (t[0] - t[2]).norm()});
}

class Cutter {
 public:
  Cutter(const MeshQuery& query, const Corners& triangle, float resolution, const std::atomic<bool>& stop)
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
    const int divisions = std::clamp(static_cast<int>(std::ceil(edge / resolution_)), 1, kMostDivisions);
    int places = 0, outside = 0;
    for (int i = 0; i <= divisions; ++i)
      for (int j = 0; i + j <= divisions; ++j) {
        ++places;
        outside += boundsOutside(query_, latticePlace(t, i, j, divisions), step_) ? 1 : 0;
        if (small && outside > 0) return out.push_back(t);
      }
    if (outside == places) return out.push_back(t);
    const bool seen_enough = edge <= kMostDivisions * resolution_;
    if (outside == 0 && seen_enough) return;
    const Vec3 ab = 0.5f * (t[0] + t[1]), bc = 0.5f * (t[1] + t[2]), ca = 0.5f * (t[2] + t[0]);
    for (const Corners& part :
         {Corners{t[0], ab, ca}, Corners{t[1], bc, ab}, Corners{t[2], ca, bc}, Corners{ab, bc, ca}})
      cut(part, out);
  }

 private:
  static constexpr int kMostDivisions = 8;
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
  Cutter(query, triangle, resolution, stop).cut(triangle, out);
  return out;
}

}  // namespace strandcast
