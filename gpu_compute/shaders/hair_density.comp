#version 450
// From sums to numbers per volume: momentum and mass as they were splatted, and the density, which is the mass blurred.
#include "kernels/lanes_glsl.h"
#include "kernels/grid.h"
#include "gpu_compute/shaders/air_settings.glsl"
#include "gpu_compute/shaders/hair_samples.glsl"
#include "gpu_compute/shaders/hair_tile.glsl"
layout(std430, binding = 7) readonly buffer Sums { ivec4 sums[]; };
layout(std430, binding = 8) buffer CrowdSums { int crowd_sums[]; };
layout(std430, binding = 9) writeonly buffer Nodes { vec4 nodes[]; };         // kg/(m^2 s), kg/m^3
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
  // What is read past the block is beyond what is used at last.
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
  crowd_sums[at] = 0;  // for what comes next
}
