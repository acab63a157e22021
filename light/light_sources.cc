#include "light/light_sources.h"

#include <algorithm>
#include <cmath>

#include "core/smooth_step.h"

namespace strandcast {

ConeCosines coneCosines(const Light& light) {
  if (light.kind == LightKind::kRectangle) return {1, 0};
  if (light.kind != LightKind::kSpot) return {-2, -3};
  const float outer = std::cos(light.cone), inner = std::cos(light.cone * (1 - light.cone_edge));
  return {std::max(inner, outer + 1e-6f), outer};  // a cone without a soft edge is sharp
}

float coneFalloff(const ConeCosines& cone, float cosine) {
  return smoothStep((cosine - cone.outer) / (cone.inner - cone.outer));
}

RectangleAxes rectangleAxes(const Vec3& axis) {
  Vec3 across = Vec3(Vec3::UnitY()).cross(axis);
  across = across.norm() > 1e-4f ? Vec3(across.normalized()) : Vec3(Vec3::UnitX());
  return {across, Vec3(axis.cross(across).normalized())};
}

}  // namespace strandcast
