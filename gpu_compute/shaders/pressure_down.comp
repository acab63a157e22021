#version 450
// variants: FINE=1 FIRST=1 | FINE=1 FIRST=0 | FINE=0 FIRST=0
// The way down of a V-cycle on one level: two sweeps from 0, and what they leave to the next level. On the finest level first
// the residual: FIRST: of the pressure as it is, else after a step of the conjugate gradients along `step`.
#include "kernels/lanes_glsl.h"
#include "gpu_compute/shaders/pressure_level.glsl"
#include "gpu_compute/shaders/pressure_tile.glsl"
layout(std430, binding = 2) readonly buffer Rights { float rights[]; };  // FIRST and coarse: right-hand sides, m/s
layout(std430, binding = 3) buffer Pressures { float pressures[]; };     // m/s, see lessGradient
layout(std430, binding = 4) readonly buffer Residuals { float residuals[]; };
layout(std430, binding = 5) writeonly buffer NewResiduals { float new_residuals[]; };
layout(std430, binding = 6) readonly buffer Steps { float steps[]; };
layout(std430, binding = 7) readonly buffer Images { float images[]; };  // of steps
layout(std430, binding = 8) readonly buffer Products { float partial_products[]; };  // dot(step, image) by tiles
layout(std430, binding = 9) writeonly buffer Smoothed { float smoothed[]; };
layout(std430, binding = 10) writeonly buffer CoarseRights { float coarse_rights[]; };
#if FINE && !FIRST
layout(location = 2) uniform int odd;  // iterations so far are
#endif

shared float right[FAR * FAR * FAR];
shared float once[FAR * FAR * FAR];
shared float twice[NEAR * NEAR * NEAR];
shared float left[INVOCATIONS];
shared uint largest;

void main() {
  if (solve.done != 0) return;
  int me = int(gl_LocalInvocationIndex);
  if (me == 0) largest = 0u;
#if FINE && !FIRST
  float product = 0.0;
  for (uint n = uint(me); n < tiles(); n += uint(INVOCATIONS)) product += partial_products[n];
  float curvature = sumOf(product), length_ = curvature > 0.0 ? solve.products[odd] / curvature : 0.0;
#endif
  barrier();
  for (int n = me; n < FAR * FAR * FAR; n += INVOCATIONS) {
    ivec3 c = cellOfBlock(n, 2);
    Stencil s = stencilOf(c);
    float r = 0.0;
    if (isOnLevel(c)) {
      int at = levelAt(c);
#if !FINE
      r = rights[at];
#else
#if FIRST
      int y = level_cells, z = y * y;
      // Faces to places beyond the grid are open, and the pressure there is 0.
      float sum = 0.0;
      if (c.x > 0) sum = madd(s.open[0], pressures[at - 1], sum);
      if (c.x + 1 < y) sum = madd(s.open[1], pressures[at + 1], sum);
      if (c.y > 0) sum = madd(s.open[2], pressures[at - y], sum);
      if (c.y + 1 < y) sum = madd(s.open[3], pressures[at + y], sum);
      if (c.z > 0) sum = madd(s.open[4], pressures[at - z], sum);
      if (c.z + 1 < y) sum = madd(s.open[5], pressures[at + z], sum);
      r = rights[at] - (s.diagonal * pressures[at] - sum);
#else
      r = madd(images[at], 0.0 - length_, residuals[at]);
#endif
      if (isOwn(c)) {
        new_residuals[at] = r;
        atomicMax(largest, floatBitsToUint(abs(r)));
#if !FIRST
        pressures[at] = madd(steps[at], length_, pressures[at]);
#endif
      }
#endif
    }
    right[n] = r;
    once[n] = kFirstWeight * s.inverse_diagonal * r;
  }
  barrier();
  for (int n = me; n < NEAR * NEAR * NEAR; n += INVOCATIONS) {
    ivec3 c = cellOfBlock(n, 1);
    Stencil s = stencilOf(c);
    int at = placeInBlock(c, 2);
    twice[n] = madd(kSecondWeight * s.inverse_diagonal, RESIDUAL(once, at, FAR, FAR * FAR, s, right[at]), once[at]);
  }
  barrier();
  ivec3 own = ivec3(gl_GlobalInvocationID);
  int near = placeInBlock(own, 1);
  left[me] = 0.0;
  if (isOnLevel(own)) {
    smoothed[levelAt(own)] = twice[near];
    Stencil s = stencilOf(own);
    left[me] = RESIDUAL(twice, near, NEAR, NEAR * NEAR, s, right[placeInBlock(own, 2)]);
  }
  barrier();
#if FINE
  if (me == 0) atomicMax(solve.residual_now, largest);
#endif
  int half_ = TILE / 2;
  ivec3 coarse = ivec3(gl_WorkGroupID) * half_ + ivec3(me % half_, me / half_ % half_, me / (half_ * half_));
  int coarse_cells = level_cells / 2;
  if (me >= half_ * half_ * half_ || any(greaterThanEqual(coarse, ivec3(coarse_cells)))) return;
  int first = 2 * (me % half_) + TILE * (2 * (me / half_ % half_) + TILE * 2 * (me / (half_ * half_)));
  float sum = 0.0;
  for (int corner = 0; corner < 8; ++corner)
    sum += left[first + (corner & 1) + TILE * ((corner >> 1) & 1) + TILE * TILE * (corner >> 2)];
  coarse_rights[coarse.x + coarse_cells * (coarse.y + coarse_cells * coarse.z)] = sum;
}
