// The lights of a picture, in units that the renderer and the path tracer share.
#pragma once
#include <cstddef>

#include "core/geometry.h"

namespace strandcast {

enum class LightKind { kDirectional, kPoint, kSpot, kRectangle };

inline constexpr size_t kMaxLights = 4;  ///< per picture

/// A light of a picture. A directional light has the irradiance `intensity` perpendicular to its direction,
/// everywhere. A point or spot light of radiant intensity `intensity` has the irradiance `intensity` / d^2 at
/// d metres (inverse-square law). A rectangle emits the same radiance in all directions of the half space
/// before it; `intensity` is its radiant intensity along its axis. The unit is the sun that the renderer is
/// exposed for (kernels/picture.h): 1 is that sun, or a lamp that is as bright at 1 m.
struct Light {
  LightKind kind = LightKind::kDirectional;
  Vec3 direction{-0.45f, -0.75f, -0.5f};  ///< direction in which the light travels, any length; of a spot and
                                          ///< of a rectangle its axis
  Vec3 position{0.45f, 0.6f, 0.6f};       ///< m, world; of a point or spot, or a rectangle's centre
  Vec3 color{1, 1, 1};                    ///< linear, 0 to 1: factors of the sun's red, green and blue
  float intensity = 1;                    ///< 0 to 10,000
  float cone = 0.45f;                 ///< rad, 0.01 to 1.5: half angle of a spot, from its axis to the edge
  float cone_edge = 0.2f;             ///< 0 to 1: outer fraction of the cone over which it fades
  float width = 0.5f, height = 0.5f;  ///< m, 0.001 to 100: a rectangle's sides; the width is horizontal
  bool casts_shadow = true;

  bool operator==(const Light&) const = default;
};

/// Cosines of the angles from the axis between which a spot light fades by 3 t^2 - 2 t^3; the outer cosine is
/// smaller. A point or directional light never fades: both are below -1. The renderer draws a rectangle as a
/// spot that fades from its axis to 90 degrees, which is near its cosine law.
struct ConeCosines {
  float inner, outer;
};
/// The cosines of a light with valid parameters.
ConeCosines coneCosines(const Light& light);

/// Factor of a spot's intensity at the cosine of an angle from its axis, 0 to 1.
float coneFalloff(const ConeCosines& cone, float cosine);

/// The axes of a rectangle: unit, along its width and its height.
struct RectangleAxes {
  Vec3 across, up;
};
/// `axis`: unit direction in which the rectangle shines. Across is horizontal; along X where it shines
/// straight up or down.
RectangleAxes rectangleAxes(const Vec3& axis);

}  // namespace strandcast
