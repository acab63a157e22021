#version 450
// variants: HAIR=0 | HAIR=1 | HAIR=2
// Momentum exchange of each cell over the step with hair and sources of wind: the sum of rate x time step, and the sum of
// rate x time step x velocity, m/s.
// Reads: sources; with HAIR momentum and density of hair; with HAIR 2 the sums of hair_slip.comp.
// Writes: exchange; with HAIR 2 also slip.
// One invocation per cell.
// HAIR: 0: sources only.
//       1: also hair.
//       2: and air slips along hair: the reduction of the exchange along the hair's directions.
#include "kernels/lanes_glsl.h"
#include "kernels/grid.h"
#include "gpu_compute/shaders/air_settings.glsl"
#include "gpu_compute/shaders/ambient.glsl"
#include "gpu_compute/shaders/wind_grid.glsl"
#if HAIR == 2
#include "gpu_compute/shaders/hair_samples.glsl"
layout(std430, binding = 7) readonly buffer SlipSums { ivec4 slip_sums[]; };  // of hair_slip.comp
layout(std430, binding = 10) writeonly buffer Slip { vec4 slip[]; };          // 2 per cell: CellSlip of wind_slip.comp
#endif
layout(std430, binding = 9) readonly buffer Nodes { vec4 nodes[]; };         // of hair_density.comp
layout(std430, binding = 5) writeonly buffer Exchange { vec4 exchange[]; };  // xyz: sum of exchange x velocity; w: exchange

void main() {
  ivec3 c;
  if (!ownCell(c)) return;
  vec3 x = air.wind_box.xyz + (vec3(c) + 0.5) * air.wind_box.w;
  vec4 sum = vec4(0);
#if HAIR == 2
  vec4 slips[2] = vec4[2](vec4(0), vec4(0));
#endif
#if HAIR
  vec3 at = transformed(air.hair_frame, x);
  if (all(greaterThan(at, vec3(0))) && all(lessThan(at, vec3(air.cells - 1)))) {
    GridPlace corner = placeAmong(at);
    int first = nodeAt(ivec3(corner.low)), y = air.cells, z = y * y;
    vec4 v[8] = vec4[8](nodes[first], nodes[first + 1], nodes[first + y], nodes[first + y + 1], nodes[first + z],
                        nodes[first + z + 1], nodes[first + z + y], nodes[first + z + y + 1]);
    sum = interpolated4(v, corner.part) * air.exchange;
#if HAIR == 2
    vec4 parts[2];
    float less = air.uniform_wind.w, per_sum = less * air.exchange * air.per_volume;
    for (int part = 0; part < 2; ++part) {
      for (int n = 0; n < 8; ++n) v[n] = vec4(slip_sums[first + part * y * z + nodeAt(cornerOf(n))]);
      parts[part] = interpolated4(v, corner.part) * (per_sum * inverse(air.mass_scale));
    }
    sum.xyz -= parts[0].xyz * (air.mass_scale * inverse(momentumScale()));
    // Directions are unit vectors, so the trace xx + yy + zz of the slip is less * sum.w; zz follows from it.
    slips[0] = vec4(parts[0].w, parts[1].x, less * sum.w - parts[0].w - parts[1].x, parts[1].y);
    slips[1].xy = parts[1].zw;
#endif
  }
#endif
  for (int i = 0; i < air.sources; ++i) {
    vec3 velocity;
    if (sources[i].position.w != kSphere && isBlown(sources[i], x, velocity))
      sum += vec4(velocity, 1) * (sources[i].direction.w * air.seconds);
  }
  if (air.spheres != 0) sum.w += sphereExchange(targetDivergence(x), air.courant);
  exchange[nodeAt(c)] = sum;
#if HAIR == 2
  for (int part = 0; part < 2; ++part) slip[2 * nodeAt(c) + part] = slips[part];
#endif
}
