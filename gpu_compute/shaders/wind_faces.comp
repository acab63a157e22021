#version 450
// variants: SPHERES=0 | SPHERES=1
// Boundary conditions before the pressure solve: finds open faces, sets faces of solids to the solids' velocity, and
// computes the right-hand sides: target divergence less outflow of each cell.
// Reads: faces, solids; with SPHERES the sources. Writes: faces, masks, right-hand sides, the largest velocity component.
// One invocation per cell.
// SPHERES: 0, 1: spheres of wind set target divergences.
#include "kernels/lanes_glsl.h"
#include "kernels/grid.h"
#include "gpu_compute/shaders/air_settings.glsl"
#include "gpu_compute/shaders/wind_grid.glsl"
#if SPHERES
#include "gpu_compute/shaders/ambient.glsl"
#endif
layout(std430, binding = 0) readonly buffer Faces { float faces[]; };
layout(std430, binding = 1) writeonly buffer Next { float next[]; };
layout(std430, binding = 2) readonly buffer Solids { vec4 solids[]; };
layout(std430, binding = 3) writeonly buffer Masks { uint masks[]; };  // see pressure_solve.glsl
layout(std430, binding = 4) writeonly buffer Rights { float rights[]; };
layout(std430, binding = 15) buffer Solve { uint fastest; }
solve;

const float kMinFaceShare = 1.0 / 6.0;  // air/wind.h
shared uint largest;

// x: velocity of a face, m/s; y: 1 if it is open, else 0.
vec2 closed(int axis, ivec3 c) {
  ivec3 before = c - along(axis);
  vec4 solid_before = c[axis] > 0 ? solids[nodeAt(before)] : vec4(0);
  vec4 solid_after = c[axis] < air.cells ? solids[nodeAt(c)] : vec4(0);
  bool wall = air.open_border == 0 && (c[axis] == 0 || c[axis] == air.cells);
  if (wall) return vec2(0);
  if (solid_after.w > 0.0) return vec2(solid_after[axis], 0);
  if (solid_before.w > 0.0) return vec2(solid_before[axis], 0);
  return vec2(faces[faceAt(axis, c)], 1);
}

#if SPHERES
// As seesBorder() of air/wind.h.
bool seesBorder(ivec3 c) {
  for (int axis = 0; axis < 3; ++axis)
    for (int by = -1; by <= 1; by += 2) {
      ivec3 at = c;
      while (isInside(at) && !(solids[nodeAt(at)].w > 0.0)) at[axis] += by;
      if (!isInside(at)) return true;
    }
  return false;
}
#endif

void main() {
  if (gl_LocalInvocationIndex == 0u) largest = 0u;
  barrier();
  ivec3 c;
  if (ownCell(c)) {
    vec2 low[3], high[3];
    uint bits = 0u;
    float size = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = closed(axis, c);
      high[axis] = closed(axis, c + along(axis));
      next[faceAt(axis, c)] = low[axis].x;
      if (c[axis] + 1 == air.cells) next[faceAt(axis, c + along(axis))] = high[axis].x;
      if (low[axis].y > 0.0) bits |= 1u << uint(2 * axis);
      if (high[axis].y > 0.0) bits |= 2u << uint(2 * axis);
      size = max(size, max(abs(low[axis].x), abs(high[axis].x)));
    }
    float flow = outflow(low[0].x, high[0].x, low[1].x, high[1].x, low[2].x, high[2].x);
    float wanted = 0.0;
#if SPHERES
    if (bits != 0u) wanted = targetDivergence(air.wind_box.xyz + (vec3(c) + 0.5) * air.wind_box.w);
    if (wanted != 0.0 && !seesBorder(c)) wanted = 0.0;
    size = max(size, kMinFaceShare * abs(wanted));
#endif
    rights[nodeAt(c)] = bits != 0u ? wanted - flow : 0.0;
    masks[nodeAt(c)] = bits | (solids[nodeAt(c)].w > 0.0 ? 64u : 0u);
    atomicMax(largest, floatBitsToUint(size));
  }
  barrier();
  if (gl_LocalInvocationIndex == 0u) atomicMax(solve.fastest, largest);
}
