#include "collision/outer_surface.h"

#include <algorithm>
#include <cmath>

namespace strandcast {

bool isInside(const MeshQuery& query, const Vec3& point) {
  return std::fabs(query.windingNumber(point)) > 0.5f;
}

bool boundsOutside(const MeshQuery& query, const Vec3& place, const Vec3& step) {
  return !isInside(query, place + step) || !isInside(query, place - step);
}

bool triangleBoundsOutside(const MeshQuery& query, const Vec3& a, const Vec3& b, const Vec3& c, float spacing,
                           float away) {
  constexpr float kMostDivisions = 32;
  constexpr float kWithin = 0.95f;  // of the way from the centroid, so as not to ask on an edge
  const Vec3 normal = (b - a).cross(c - a), centre = (a + b + c) / 3;
  const float length = normal.norm();
  const Vec3 step = length > 0 ? Vec3(normal * (away / length)) : Vec3(Vec3::Zero());
  if (boundsOutside(query, centre, step)) return true;
  const float edge = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
  const int n = static_cast<int>(std::clamp(std::ceil(edge / spacing), 1.0f, kMostDivisions));
  for (int i = 0; i <= n; ++i)
    for (int j = 0; i + j <= n; ++j) {
      const Vec3 place =
          a + (static_cast<float>(i) * (b - a) + static_cast<float>(j) * (c - a)) / static_cast<float>(n);
      if (boundsOutside(query, centre + kWithin * (place - centre), step)) return true;
    }
  return false;
}

}  // namespace strandcast
