#version 450
// Cells whose middle is in a body at the end of the step, and how they move.
#include "kernels/lanes_glsl.h"
#include "kernels/rotation.h"
#include "kernels/contact.h"
#include "kernels/distance_field.h"
#include "kernels/grid.h"
#define ACCELERATED 0
#include "gpu_compute/shaders/step_input.glsl"
#include "gpu_compute/shaders/strand_offsets.glsl"
#include "gpu_compute/shaders/bodies.glsl"
#include "gpu_compute/shaders/air_settings.glsl"
#include "gpu_compute/shaders/wind_grid.glsl"
layout(std430, binding = 0) writeonly buffer Solids { vec4 solids[]; };  // m/s; w: 1 where there is a body

bool mayBeIn(Primitive p, vec3 x) {
  if (p.kind == kPlane) return true;
  vec3 low = min(p.a_begin_radius.xyz, p.a_end), high = max(p.a_begin_radius.xyz, p.a_end);
  float radius = p.a_begin_radius.w;
  if (p.kind == kCapsule || p.kind == kTaperedCapsule) {
    low = min(low, min(p.b_begin_friction.xyz, p.b_end_radius.xyz));
    high = max(high, max(p.b_begin_friction.xyz, p.b_end_radius.xyz));
    if (p.kind == kTaperedCapsule) radius = max(radius, p.b_end_radius.w);
  }
  return all(greaterThanEqual(x, low - radius)) && all(lessThanEqual(x, high + radius));
}

void main() {
  ivec3 c;
  if (!ownCell(c)) return;
  vec3 x = air.wind_box.xyz + (vec3(c) + 0.5) * air.wind_box.w, normal;
  vec4 solid = vec4(0);
  for (int i = 0; i < air.bodies; ++i) {
    Primitive p = primitives[i];
    if (!mayBeIn(p, x) || !(surfaceAt(bodyAt(uint(i), 1.0), x, 0.0, normal) < 0.0)) continue;
    vec3 motion = (p.a_end - p.a_begin_radius.xyz) / air.seconds;
    solid = vec4(motion + cross(p.angular_velocity, x - p.a_end), 1.0);
  }
  solids[nodeAt(c)] = solid;
}
