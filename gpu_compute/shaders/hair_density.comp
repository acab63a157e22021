#version 450
// Converts the sums of hair_splat.comp to quantities per volume: momentum and mass as splatted, and the density, which is
// the mass blurred by (1 2 1) / 4 along each axis.
// Reads: sums per node. Writes: momentum and mass per volume, densities; clears the sums of hair_crowd.comp.
// One invocation per node of the hair grid.
#include "kernels/lanes_glsl.h"
#include "kernels/grid.h"
#include "gpu_compute/shaders/air_settings.glsl"
#include "gpu_compute/shaders/hair_samples.glsl"
#include "gpu_compute/shaders/hair_tile.glsl"
layout(std430, binding = 7) readonly buffer Sums { ivec4 sums[]; };
layout(std430, binding = 8) buffer CrowdSums { int crowd_sums[]; };
layout(std430, binding = 9) writeonly buffer Nodes { vec4 nodes[]; };            // xyz: kg/(m^2 s); w: kg/m^3
layout(std430, binding = 10) writeonly buffer Densities { float densities[]; };  // kg/m^3

#define SIDE (TILE + 2)
shared float here[SIDE * SIDE * SIDE];
shared float there[SIDE * SIDE * SIDE];

void main() {
  float density = inverse(air.mass_scale) * air.per_volume, flow = inverse(momentumScale()) * air.per_volume;
  int me = int(gl_LocalInvocationIndex);
  for (int n = me; n < SIDE * SIDE * SIDE; n += INVOCATIONS) {
    ivec3 node = nodeOfBlock(n, SIDE, 1);
    here[n] = isInside(node) ? density * float(sums[nodeAt(node)].w) : 0.0;
  }
  barrier();
  // Values at the block's rim are wrong, since their neighbours are clamped, but the result does not use them.
  for (int n = me; n < SIDE * SIDE * SIDE; n += INVOCATIONS)
    there[n] = blurred(here[max(n - 1, 0)], here[n], here[min(n + 1, SIDE * SIDE * SIDE - 1)]);
  barrier();
  for (int n = me; n < SIDE * SIDE * SIDE; n += INVOCATIONS)
    here[n] = blurred(there[max(n - SIDE, 0)], there[n], there[min(n + SIDE, SIDE * SIDE * SIDE - 1)]);
  barrier();
  ivec3 node = ivec3(gl_GlobalInvocationID);
  int own = placeInBlock(node, SIDE, 1);
  int at = nodeAt(node);
  densities[at] = blurred(here[own - SIDE * SIDE], here[own], here[own + SIDE * SIDE]);
  ivec4 sum = sums[at];
  nodes[at] = vec4(vec3(sum.xyz) * flow, float(sum.w) * density);
  crowd_sums[at] = 0;  // for hair_crowd.comp
}
