#version 450
// variants: CROWDS=1 RUBS=1 | CROWDS=0 RUBS=1 | CROWDS=1 RUBS=0
// Change of velocity of hair at a node over the step: pressure along the density gradient, and friction towards the mean
// velocity. hair_gather.comp applies it to vertices.
// Reads: momentum and mass per volume, densities, sums of hair_crowd.comp.
// Writes: changes, xyz: m/s; w: the fraction of a sample's own velocity to subtract. Clears the sums of hair_splat.comp.
// One invocation per node of the hair grid.
// CROWDS: 0, 1: pressure is on (volume_stiffness > 0).
// RUBS: 0, 1: friction is on (hair_friction > 0).
#include "kernels/lanes_glsl.h"
#include "kernels/grid.h"
#include "gpu_compute/shaders/air_settings.glsl"
#include "gpu_compute/shaders/hair_tile.glsl"
layout(std430, binding = 7) writeonly buffer Sums { ivec4 sums[]; };
layout(std430, binding = 8) readonly buffer CrowdSums { int crowd_sums[]; };
layout(std430, binding = 9) readonly buffer Nodes { vec4 nodes[]; };
layout(std430, binding = 10) readonly buffer Densities { float densities[]; };
layout(std430, binding = 11) writeonly buffer Changes { vec4 changes[]; };

#define SIDE (TILE + 4)
#define NUMBERS (SIDE * SIDE * SIDE)
shared float here[NUMBERS];
shared float there[NUMBERS];
shared uint any_hair;

// Blurs `here` along x, y and z into `there`. SIDE leaves a margin for one central difference of the result.
void blur() {
  int me = int(gl_LocalInvocationIndex);
  barrier();
  for (int n = me; n < NUMBERS; n += INVOCATIONS) there[n] = blurred(here[max(n - 1, 0)], here[n], here[min(n + 1, NUMBERS - 1)]);
  barrier();
  for (int n = me; n < NUMBERS; n += INVOCATIONS)
    here[n] = blurred(there[max(n - SIDE, 0)], there[n], there[min(n + SIDE, NUMBERS - 1)]);
  barrier();
  for (int n = me; n < NUMBERS; n += INVOCATIONS)
    there[n] = blurred(here[max(n - SIDE * SIDE, 0)], here[n], here[min(n + SIDE * SIDE, NUMBERS - 1)]);
  barrier();
}
float densityAt(ivec3 node) { return isInside(node) ? densities[nodeAt(node)] : 0.0; }

void main() {
  ivec3 node = ivec3(gl_GlobalInvocationID);
  int at = nodeAt(node), own = placeInBlock(node, SIDE, 2), me = int(gl_LocalInvocationIndex);
  vec4 mine = nodes[at], change = vec4(0);
  sums[at] = ivec4(0);  // for the next step
  if (me == 0) any_hair = 0u;
  barrier();
  if (mine.w > 0.0) any_hair = 1u;
  barrier();
  if (any_hair == 0u) {
    changes[at] = vec4(0);
    return;
  }
#if CROWDS
  float back = inverse(air.crowd_scale) * air.per_volume;
  for (int n = me; n < NUMBERS; n += INVOCATIONS) {
    ivec3 other = nodeOfBlock(n, SIDE, 2);
    here[n] = isInside(other) ? back * float(crowd_sums[nodeAt(other)]) : 0.0;
  }
  blur();
  float crowd = mine.w > 0.0 ? back * float(crowd_sums[at]) / mine.w : 0.0;
  vec3 push;
  for (int axis = 0; axis < 3; ++axis) {
    int next = axis == 0 ? 1 : axis == 1 ? SIDE : SIDE * SIDE;
    push[axis] = pushAlong(crowd, densityAt(node - along(axis)), densityAt(node + along(axis)), there[own - next],
                           there[own + next], air.slope);
  }
  change.xyz = vec3(dot(air.turn[0].xyz, push), dot(air.turn[1].xyz, push), dot(air.turn[2].xyz, push));
#endif
#if RUBS
  float thin = mine.w > 0.0 ? inverse(sqrt(densities[at])) : 0.0;
  for (int c = 0; c < 4; ++c) {
    barrier();
    for (int n = me; n < NUMBERS; n += INVOCATIONS) {
      ivec3 other = nodeOfBlock(n, SIDE, 2);
      float value = 0.0;
      if (isInside(other)) {
        vec4 theirs = nodes[nodeAt(other)];
        value = theirs.w > 0.0 ? theirs[c] * inverse(sqrt(densities[nodeAt(other)])) : 0.0;
      }
      here[n] = value;
    }
    blur();
    change[c] += air.friction * thin * there[own];
  }
#endif
  changes[at] = mine.w > 0.0 ? change : vec4(0);
}
