#version 450
// variants: MEASURE=0 | MEASURE=1
// How much denser than at rest hair is where samples are, and mass x that to the nodes around them, in whole numbers.
// MEASURE: the density there is that at rest.
#define WORKGROUP 128
layout(local_size_x = WORKGROUP) in;
#include "kernels/lanes_glsl.h"
#include "kernels/grid.h"
#include "gpu_compute/shaders/air_settings.glsl"
#include "gpu_compute/shaders/hair_samples.glsl"
layout(std430, binding = 0) buffer Resting { vec2 resting[]; };  // per sample: kg; kg/m^3, its density at rest
layout(std430, binding = 1) buffer Held { float held[]; };       // heldCrowding, per sample
layout(std430, binding = 8) buffer CrowdSums { int crowd_sums[]; };
layout(std430, binding = 10) readonly buffer Densities { float densities[]; };

shared float found[WORKGROUP];
shared vec3 parts[WORKGROUP];
shared int nodes[WORKGROUP];

void main() {
  uint me = gl_LocalInvocationID.x, n = workgroupNumber() * WORKGROUP + me;
  found[me] = 0.0;
  if (n < air.samples) {
    vec3 at = placeOf(n);
    if (isInGrid(at)) {
      GridPlace corner = placeAmong(at);
      int first = nodeAt(ivec3(corner.low)), y = air.cells, z = y * y;
      float density = interpolated(densities[first], densities[first + 1], densities[first + y], densities[first + y + 1],
                                   densities[first + z], densities[first + z + 1], densities[first + z + y],
                                   densities[first + z + y + 1], corner.part);
#if MEASURE
      resting[n].y = density;
#else
      vec2 own = resting[n];
      float rest = own.y * air.rest_scale;
      float most = largestCrowding(rest, own.x * air.alone) * air.stiffness * kMostHeld;
      float now_held = heldCrowding(held[n], density, rest, air.stiffness, air.gain, most);
      held[n] = now_held;
      nodes[me] = first;
      parts[me] = corner.part;
      found[me] = own.x * (crowding(density, rest, air.stiffness) + now_held) * air.crowd_scale;
#endif
    }
  }
#if !MEASURE
  barrier();
  float right = float(me & 1u);
  for (uint round = 0u; round < 2u; ++round) {
    uint s = round * (WORKGROUP / 2u) + me / 2u;
    if (!(found[s] > 0.0)) continue;
    for (int pair = 0; pair < 4; ++pair) {
      int share = int(fixedPoint(found[s] * splatWeight(parts[s], right, float(pair & 1), float(pair >> 1))));
      if (share != 0)
        atomicAdd(crowd_sums[nodes[s] + int(right) + air.cells * ((pair & 1) + air.cells * (pair >> 1))], share);
    }
  }
#endif
}
