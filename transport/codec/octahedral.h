#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/geometry.h"
#include "transport/codec/nearest.h"

namespace strandcast {

/// Directions as a point of the octahedron |x| + |y| + |z| = 1, its lower half folded outwards onto the unit
/// square (Meyer et al., On Floating-Point Normal Vectors, EGSR 2010; Cigolle et al., A Survey of Efficient
/// Representations for Independent Unit Vectors, JCGT 2014). Coordinates from 0 to 2^bits - 1.
struct OctahedralPoint {
  uint16_t u = 0, v = 0;
};

inline float octahedralFold(float across, float along) {
  return (1 - std::abs(across)) * (along >= 0 ? 1.0f : -1.0f);
}

/// Of a direction of any length but 0: the point whose direction is nearest. Rounding each coordinate by
/// itself would err by half as much again where the octahedron's faces are steepest to its axes.
inline OctahedralPoint toOctahedral(const Vec3& direction, int bits) {
  const float scale = 1 / (std::abs(direction.x()) + std::abs(direction.y()) + std::abs(direction.z()));
  const Vec3 p = direction * scale;
  const float sign_x = p.x() >= 0 ? 1.0f : -1.0f, sign_y = p.y() >= 0 ? 1.0f : -1.0f;
  const bool below = p.z() < 0;
  const float u = below ? octahedralFold(p.y(), p.x()) : p.x(),
              v = below ? octahedralFold(p.x(), p.y()) : p.y();
  const float steps = static_cast<float>((1 << bits) - 1);
  const float at[2] = {std::clamp(u * 0.5f + 0.5f, 0.0f, 1.0f) * steps,
                       std::clamp(v * 0.5f + 0.5f, 0.0f, 1.0f) * steps};
  float nearest[2], off[2], other[2];
  for (int k = 0; k < 2; ++k) {
    nearest[k] = static_cast<float>(strandcast::nearest(at[k]));
    off[k] = nearest[k] - at[k];
    other[k] = nearest[k] - std::copysign(1.0f, off[k]);
    if (other[k] < 0 || other[k] > steps) other[k] = nearest[k];
  }
  // How far the direction turns when the point moves by (du, dv), squared and to first order: what is left of
  // the movement on the octahedron without its part along the direction.
  const float turned = below ? -sign_x * sign_y : 1.0f;
  const Vec3 along_u = below ? Vec3(0, turned, -sign_x) : Vec3(1, 0, -sign_x);
  const Vec3 along_v = below ? Vec3(turned, 0, -sign_y) : Vec3(0, 1, -sign_y);
  const float radial_u = along_u.dot(p), radial_v = along_v.dot(p), inverse = 1 / p.squaredNorm();
  const float uu = 2 - radial_u * radial_u * inverse, vv = 2 - radial_v * radial_v * inverse;
  const float uv = along_u.dot(along_v) - radial_u * radial_v * inverse;
  const auto error = [&](float du, float dv) { return uu * du * du + 2 * uv * du * dv + vv * dv * dv; };
  float best[2] = {nearest[0], nearest[1]}, least = error(off[0], off[1]);
  const auto consider = [&](float a, float b) {
    const float e = error(a - at[0], b - at[1]);
    if (e < least) least = e, best[0] = a, best[1] = b;
  };
  consider(other[0], nearest[1]);
  consider(nearest[0], other[1]);
  consider(other[0], other[1]);
  return {static_cast<uint16_t>(best[0]), static_cast<uint16_t>(best[1])};
}

/// Of unit length.
inline Vec3 fromOctahedral(OctahedralPoint point, int bits) {
  const float step = 2 / static_cast<float>((1 << bits) - 1);
  float x = static_cast<float>(point.u) * step - 1, y = static_cast<float>(point.v) * step - 1;
  const float z = 1 - std::abs(x) - std::abs(y);
  if (z < 0) {
    const float folded = octahedralFold(y, x);
    y = octahedralFold(x, y);
    x = folded;
  }
  const float inverse = 1 / std::sqrt(x * x + y * y + z * z);
  return {x * inverse, y * inverse, z * inverse};
}

}  // namespace strandcast
