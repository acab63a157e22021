#pragma once
#include "air/wind_source.h"

namespace strandcast {

/// Blows everything within 10 m towards +x.
inline WindSource wideFan(float speed) {
  WindSource fan;
  fan.kind = WindSource::Kind::kTurbine;
  fan.direction = Vec3::UnitX();
  fan.radius = fan.length = 10;
  fan.speed = speed;
  return fan;
}

}  // namespace strandcast
