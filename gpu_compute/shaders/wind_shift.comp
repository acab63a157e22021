#version 450
// variants: CENTRES=0 | CENTRES=1
// Moves the box of the wind grid by whole cells. Air keeps its position in the world; new faces get the ambient wind, or 0
// between walls, and new cells a pressure of 0.
// Reads: faces, pressures, ambient wind. Writes: faces and pressures; with CENTRES only cell-centre velocities.
// One invocation per face (or cell, with CENTRES).
// CENTRES: 0: shifts.
//          1: only interpolates face velocities to cell centres.
#include "kernels/lanes_glsl.h"
#include "kernels/grid.h"
#include "gpu_compute/shaders/air_settings.glsl"
#include "gpu_compute/shaders/ambient.glsl"
#include "gpu_compute/shaders/wind_grid.glsl"
layout(std430, binding = 0) readonly buffer Faces { float faces[]; };
layout(std430, binding = 1) writeonly buffer Next { float next[]; };
layout(std430, binding = 2) writeonly buffer Centres { vec4 centres[]; };
layout(std430, binding = 3) readonly buffer Pressures { float pressures[]; };
layout(std430, binding = 4) writeonly buffer NextPressures { float next_pressures[]; };

void main() {
  ivec3 c;
#if CENTRES
  if (!ownCell(c)) return;
  vec4 middle = vec4(0);
  for (int axis = 0; axis < 3; ++axis) middle[axis] = 0.5 * (faces[faceAt(axis, c)] + faces[faceAt(axis, c + along(axis))]);
  centres[nodeAt(c)] = middle;
#else
  ivec3 shift = ivec3(air.shift_x, air.shift_y, air.shift_z);
  if (ownCell(c)) next_pressures[nodeAt(c)] = isInside(c + shift) ? pressures[nodeAt(c + shift)] : 0.0;
  int axis;
  if (!ownFace(axis, c)) return;
  ivec3 from = c + shift;
  bool known = all(greaterThanEqual(from, ivec3(0))) && all(lessThan(from, ivec3(air.cells) + along(axis)));
  float value = 0.0;
  if (known)
    value = faces[faceAt(axis, from)];
  else if (air.open_border != 0)
    value = ambientAt(middleOfFace(axis, c))[axis];
  next[faceAt(axis, c)] = value;
#endif
}
