#version 450
// Projection: subtracts the pressure gradient from open faces, and interpolates velocities to cell centres.
// Reads: faces, masks, pressures. Writes: faces, cell-centre velocities.
// One invocation per cell.
#include "kernels/lanes_glsl.h"
#include "kernels/grid.h"
#include "gpu_compute/shaders/air_settings.glsl"
#include "gpu_compute/shaders/wind_grid.glsl"
layout(std430, binding = 0) readonly buffer Faces { float faces[]; };
layout(std430, binding = 1) writeonly buffer Next { float next[]; };
layout(std430, binding = 2) writeonly buffer Centres { vec4 centres[]; };
layout(std430, binding = 3) readonly buffer Masks { uint masks[]; };
layout(std430, binding = 4) readonly buffer Pressures { float pressures[]; };

float pressureAt(ivec3 c) { return isInside(c) ? pressures[nodeAt(c)] : 0.0; }

void main() {
  ivec3 c;
  if (!ownCell(c)) return;
  uint bits = masks[nodeAt(c)];
  float own = pressures[nodeAt(c)];
  vec4 middle = vec4(0);
  for (int axis = 0; axis < 3; ++axis) {
    float open_low = float((bits >> uint(2 * axis)) & 1u), open_high = float((bits >> uint(2 * axis + 1)) & 1u);
    ivec3 after = c + along(axis);
    float low = projectVelocity(faces[faceAt(axis, c)], open_low, pressureAt(c - along(axis)), own);
    float high = projectVelocity(faces[faceAt(axis, after)], open_high, own, pressureAt(after));
    next[faceAt(axis, c)] = low;
    if (c[axis] + 1 == air.cells) next[faceAt(axis, after)] = high;
    middle[axis] = 0.5 * (low + high);
  }
  centres[nodeAt(c)] = middle;
}
