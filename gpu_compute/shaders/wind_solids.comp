#version 450
// variants: SHAPE_KINDS=1 | SHAPE_KINDS=2
// Solid cells: those whose centre is inside a body at the end of the step, and the body's velocity there.
// Reads: bodies. Writes: solids.
// One invocation per cell.
// SHAPE_KINDS: 1 or 2, see bodies.glsl.
#include "kernels/lanes_glsl.h"
#include "kernels/rotation.h"
#include "kernels/contact.h"
#include "kernels/distance_field.h"
#include "kernels/grid.h"
#define ACCELERATED 0
#include "gpu_compute/shaders/step_input.glsl"
#include "gpu_compute/shaders/bodies.glsl"
#include "gpu_compute/shaders/air_settings.glsl"
#include "gpu_compute/shaders/wind_grid.glsl"
layout(std430, binding = 0) writeonly buffer Solids { vec4 solids[]; };  // xyz: velocity, m/s; w: 1: solid

void main() {
  ivec3 c;
  if (!ownCell(c)) return;
  vec3 x = air.wind_box.xyz + (vec3(c) + 0.5) * air.wind_box.w, normal;
  vec4 solid = vec4(0);
  for (int i = 0; i < air.bodies; ++i) {
    PlacedBody body = bodies[i];  // a_motion is over the whole step, turn is radians per second
    vec3 off = x - body.middle;
    if (dot(off, off) > body.ball * body.ball || !(surfaceAt(body, x, 0.0, normal) < 0.0)) continue;
    solid = vec4(body.a_motion / air.seconds + cross(body.turn, x - body.a), 1.0);
  }
  solids[nodeAt(c)] = solid;
}
