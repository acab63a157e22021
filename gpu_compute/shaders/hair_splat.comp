#version 450
// variants: MEASURE=0 | MEASURE=1
// Mass and momentum of samples to the nodes around them, in whole numbers, so that sums do not depend on their order. First
// an invocation a sample; then eight an invocation each of the 2 x 4 numbers of two nodes beside each other, so that what is
// added at once is 32 bytes in a row. MEASURE: only finds the largest velocity.
#define WORKGROUP 128
layout(local_size_x = WORKGROUP) in;
#include "kernels/lanes_glsl.h"
#include "kernels/grid.h"
#include "gpu_compute/shaders/air_settings.glsl"
#include "gpu_compute/shaders/hair_pieces.glsl"
#include "gpu_compute/shaders/hair_samples.glsl"
layout(std430, binding = 7) buffer Sums { int sums[]; };  // 4 per node: momentum, mass

shared vec4 found[WORKGROUP];  // momentum and mass in whole numbers' units
shared vec3 parts[WORKGROUP];
shared int nodes[WORKGROUP];   // the first of the eight, -1: left out
shared uint fastest;

void main() {
  const float kSane = 1e4;  // m/s
  uint me = gl_LocalInvocationID.x, first = workgroupNumber() * WORKGROUP, n = first + me;
  if (me == 0u) fastest = 0u;
  barrier();
  nodes[me] = -1;
  if (n < air.samples) {
    vec3 place, motion;
    float mass;
    middleOf(pieceOf(n), place, motion, mass);
    vec3 size = abs(motion);
    bool sane = size.x < kSane && size.y < kSane && size.z < kSane;
    if (sane) atomicMax(fastest, floatBitsToUint(max(size.x, max(size.y, size.z))));
#if !MEASURE
    vec3 at = transformed(air.hair_frame, place);
    if (!sane) at = vec3(-1);
    places[3u * n] = at.x;
    places[3u * n + 1u] = at.y;
    places[3u * n + 2u] = at.z;
    if (isInGrid(at)) {
      GridPlace corner = placeAmong(at);
      float most = fastestSplatted();
      nodes[me] = nodeAt(ivec3(corner.low));
      parts[me] = corner.part;
      found[me] = mass * vec4(clamp(motion, vec3(-most), vec3(most)) * momentumScale(), air.mass_scale);
    }
#endif
  }
  barrier();
#if MEASURE
  if (me == 0u) atomicMax(fastest_before, fastest);
#else
  if (me == 0u) atomicMax(fastest_now, fastest);
  // Rounds of WORKGROUP / 8 samples: each of the four pairs of nodes.
  uint number = me & 3u;
  float right = float((me >> 2u) & 1u);
  for (uint round = 0u; round < 8u; ++round) {
    uint s = round * (WORKGROUP / 8u) + me / 8u;
    if (nodes[s] < 0) continue;
    float value = found[s][number];
    int node = nodes[s] + int(right);
    for (int pair = 0; pair < 4; ++pair) {
      float up = float(pair & 1), back = float(pair >> 1);
      int share = int(fixedPoint(value * splatWeight(parts[s], right, up, back)));
      if (share != 0) atomicAdd(sums[4 * (node + air.cells * ((pair & 1) + air.cells * (pair >> 1))) + int(number)], share);
    }
  }
#endif
}
