#version 450
// variants: FINE=1 | FINE=0
// The way up of a V-cycle on one level: the next level's correction, and two sweeps.
#include "kernels/lanes_glsl.h"
#include "gpu_compute/shaders/pressure_level.glsl"
#include "gpu_compute/shaders/pressure_tile.glsl"
layout(std430, binding = 2) readonly buffer Rights { float rights[]; };
layout(std430, binding = 9) readonly buffer Smoothed { float smoothed[]; };
layout(std430, binding = 10) readonly buffer Corrections { float corrections[]; };  // of the next level
layout(std430, binding = 11) writeonly buffer Results { float results[]; };
layout(std430, binding = 8) writeonly buffer Products { float partial_products[]; };  // FINE: dot(right, result) by tiles

shared float before[FAR * FAR * FAR];
shared float once[NEAR * NEAR * NEAR];

void main() {
  if (solve.done != 0) return;
  int me = int(gl_LocalInvocationIndex), coarse_cells = level_cells / 2;
  for (int n = me; n < FAR * FAR * FAR; n += INVOCATIONS) {
    ivec3 c = cellOfBlock(n, 2);
    float x = 0.0;
    if (isOnLevel(c)) {
      ivec3 coarse = c / 2;
      float add = corrections[coarse.x + coarse_cells * (coarse.y + coarse_cells * coarse.z)];
      x = smoothed[levelAt(c)] + (stencilOf(c).inverse_diagonal > 0.0 ? add : 0.0);
    }
    before[n] = x;
  }
  barrier();
  for (int n = me; n < NEAR * NEAR * NEAR; n += INVOCATIONS) {
    ivec3 c = cellOfBlock(n, 1);
    Stencil s = stencilOf(c);
    int at = placeInBlock(c, 2);
    float right = isOnLevel(c) ? rights[levelAt(c)] : 0.0;
    once[n] = madd(kSecondWeight * s.inverse_diagonal, RESIDUAL(before, at, FAR, FAR * FAR, s, right), before[at]);
  }
  barrier();
  ivec3 own = ivec3(gl_GlobalInvocationID);
  float product = 0.0;
  if (isOnLevel(own)) {
    Stencil s = stencilOf(own);
    int at = placeInBlock(own, 1);
    float right = rights[levelAt(own)];
    float x = madd(kFirstWeight * s.inverse_diagonal, RESIDUAL(once, at, NEAR, NEAR * NEAR, s, right), once[at]);
    results[levelAt(own)] = x;
    product = right * x;
  }
#if FINE
  float sum = sumOf(product);
  if (me == 0) partial_products[tileNumber()] = sum;
#endif
}
