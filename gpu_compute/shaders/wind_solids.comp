#version 450
// variants: TURNING=1 | TURNING=2
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

void main() {
  ivec3 c;
  if (!ownCell(c)) return;
  vec3 x = air.wind_box.xyz + (vec3(c) + 0.5) * air.wind_box.w, normal;
  vec4 solid = vec4(0);
  for (int i = 0; i < air.bodies; ++i) {
    PlacedBody body = bodies[i];  // its motion is that of the step, its turn that of a second
    vec3 off = x - body.middle;
    if (dot(off, off) > body.ball * body.ball || !(surfaceAt(body, x, 0.0, normal) < 0.0)) continue;
    solid = vec4(body.a_motion / air.seconds + cross(body.turn, x - body.a), 1.0);
  }
  solids[nodeAt(c)] = solid;
}
