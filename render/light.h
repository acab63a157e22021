#pragma once
#include <cstddef>
#include <string>

#include "core/geometry.h"

namespace strandcast {

enum class LightKind { kDirectional, kPoint, kSpot };

inline constexpr size_t kMostLights = 4;  ///< of a picture

/// One of the lights of a picture. A directional light's irradiance across its way is `intensity` everywhere;
/// that of a point or spot light of radiant intensity `intensity` is `intensity` / d^2 at d metres
/// (inverse-square law). Both in units of the sun that the renderer is exposed for, so that 1 is that sun, or
/// a lamp that is as bright 1 m away.
struct Light {
  LightKind kind = LightKind::kDirectional;
  Vec3 direction{-0.45f, -0.75f, -0.5f};  ///< the way the light travels, any length; of a spot its axis
  Vec3 position{0.45f, 0.6f, 0.6f};       ///< m, world; of a point or spot light
  Vec3 color{1, 1, 1};                    ///< linear, 0 to 1: factors of the sun's red, green and blue
  float intensity = 1;                    ///< 0 to 10,000
  float cone = 0.45f;                     ///< rad, 0.01 to 1.5: of a spot, from its axis to where it ends
  float cone_edge = 0.2f;                 ///< 0 to 1: outer part of that over which it fades
  bool casts_shadow = true;

  bool operator==(const Light&) const = default;
};

/// What shaders are compiled for.
struct LightCounts {
  size_t lights = 0, casters = 0;  ///< those that cast shadows are the first ones
  bool operator==(const LightCounts&) const = default;
};
/// As shaders have them: "#define LIGHTS 2\n...".
std::string lightDefines(const LightCounts& counts);

/// Cosines of the angles from the axis between which a spot light fades, smoothly (3 t^2 - 2 t^3), the outer
/// one the smaller; both below -1, so that it never fades, for the other kinds.
struct ConeCosines {
  float inner, outer;
};
ConeCosines coneCosines(const Light& light);

}  // namespace strandcast
