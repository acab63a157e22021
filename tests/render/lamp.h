#pragma once
#include <algorithm>
#include <cmath>

#include "render/render_settings.h"

namespace strandcast {

/// The light that arrives at a point by the light's definition, in double precision.
struct Arriving {
  Eigen::Vector3d towards;  ///< unit, towards the light
  double irradiance;        ///< perpendicular to `towards`, unshadowed, relative to the sun's
};
inline Arriving arriving(const Light& light, const Eigen::Vector3d& point) {
  const Eigen::Vector3d axis = light.direction.cast<double>().normalized();
  if (light.kind == LightKind::kDirectional) return {-axis, static_cast<double>(light.intensity)};
  const Eigen::Vector3d off = light.position.cast<double>() - point;
  Arriving result{off.normalized(), static_cast<double>(light.intensity) / off.squaredNorm()};
  if (light.kind == LightKind::kPoint) return result;
  const double outer = std::cos(static_cast<double>(light.cone)),
               inner = std::cos(static_cast<double>(light.cone * (1 - light.cone_edge)));
  const double t = std::clamp((-result.towards.dot(axis) - outer) / (inner - outer), 0.0, 1.0);
  result.irradiance *= t * t * (3 - 2 * t);
  return result;
}

inline Light pointLight(const Vec3& position, float intensity) {
  Light light;
  light.kind = LightKind::kPoint;
  light.position = position;
  light.intensity = intensity;
  return light;
}
inline Light spotLight(const Vec3& position, const Vec3& direction, float cone, float intensity) {
  Light light = pointLight(position, intensity);
  light.kind = LightKind::kSpot;
  light.direction = direction;
  light.cone = cone;
  return light;
}

}  // namespace strandcast
