#pragma once
#include <cstddef>
#include <string>

#include "core/geometry.h"

namespace strandcast {

enum class LightKind { kDirectional, kPoint, kSpot };

inline constexpr size_t kMaxLights = 4;  ///< per picture

/// A light of a picture. A directional light has the irradiance `intensity` perpendicular to its direction,
/// everywhere. A point or spot light of radiant intensity `intensity` has the irradiance `intensity` / d^2 at
/// d metres (inverse-square law). The unit is the sun that the renderer is exposed for: 1 is that sun, or a
/// lamp that is as bright at 1 m.
struct Light {
  LightKind kind = LightKind::kDirectional;
  Vec3 direction{-0.45f, -0.75f, -0.5f};  ///< direction in which the light travels, any length; of a spot its
                                          ///< axis
  Vec3 position{0.45f, 0.6f, 0.6f};       ///< m, world; of a point or spot light
  Vec3 color{1, 1, 1};                    ///< linear, 0 to 1: factors of the sun's red, green and blue
  float intensity = 1;                    ///< 0 to 10,000
  float cone = 0.45f;      ///< rad, 0.01 to 1.5: half angle of a spot, from its axis to the edge
  float cone_edge = 0.2f;  ///< 0 to 1: outer fraction of the cone over which it fades
  bool casts_shadow = true;

  bool operator==(const Light&) const = default;
};

/// Numbers of lights for which shaders are compiled.
struct LightCounts {
  size_t lights = 0, casters = 0;  ///< lights that cast shadows come first
  bool operator==(const LightCounts&) const = default;
};
/// The preprocessor defines for shaders: "#define LIGHTS 2\n...".
std::string lightDefines(const LightCounts& counts);

/// Cosines of the angles from the axis between which a spot light fades by 3 t^2 - 2 t^3; the outer cosine is
/// smaller. Both are below -1 for other kinds, which never fade.
struct ConeCosines {
  float inner, outer;
};
/// The cosines of a light with valid parameters.
ConeCosines coneCosines(const Light& light);

}  // namespace strandcast
