#pragma once
#include "core/geometry.h"

namespace strandcast {

enum class LightKind { kDirectional, kPoint, kSpot };

/// The light of a picture. A directional light's irradiance across its way is `intensity` everywhere; that of
/// a point or spot light of radiant intensity `intensity` is `intensity` / d^2 at d metres (inverse-square
/// law). Both in units of the sun that the renderer is exposed for, so that 1 is that sun, or a lamp that is
/// as bright 1 m away.
struct Light {
  LightKind kind = LightKind::kDirectional;
  Vec3 direction{-0.45f, -0.75f, -0.5f};  ///< the way the light travels, any length; of a spot its axis
  Vec3 position{0.45f, 0.6f, 0.6f};       ///< m, world; of a point or spot light
  float intensity = 1;                    ///< 0 to 10,000
  float cone = 0.45f;                     ///< rad, 0.01 to 1.5: of a spot, from its axis to where it ends
  float cone_edge = 0.2f;                 ///< 0 to 1: outer part of that over which it fades

  bool operator==(const Light&) const = default;
};

/// Cosines of the angles from the axis between which a spot light fades, smoothly (3 t^2 - 2 t^3), the outer
/// one the smaller; both below -1, so that it never fades, for the other kinds.
struct ConeCosines {
  float inner, outer;
};
ConeCosines coneCosines(const Light& light);

}  // namespace strandcast
