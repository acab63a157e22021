#version 450
// variants: ONWARD=0 | ONWARD=1
// Displacement over the step, in cells, of the air that arrives at each cell centre, by the midpoint rule.
// Reads: cell-centre velocities. Writes: displacements; with ONWARD also onwards.
// One invocation per cell.
// ONWARD: 0; 1: also minus the displacement of the air that leaves the cell centre, for MacCormack's correction.
#include "kernels/lanes_glsl.h"
#include "kernels/grid.h"
#include "gpu_compute/shaders/air_settings.glsl"
#include "gpu_compute/shaders/wind_grid.glsl"
layout(std430, binding = 2) readonly buffer Centres { vec4 centres[]; };
layout(std430, binding = 3) writeonly buffer Displacements { vec4 displacements[]; };
layout(std430, binding = 4) writeonly buffer Onwards { vec4 onwards[]; };

// Backward displacement, in cells; with a negative `courant`, minus the forward one.
vec4 displacement(ivec3 c, float courant) {
  vec3 middle = tracedBack(vec3(c), centres[nodeAt(c)].xyz, 0.5 * courant);
  GridPlace corner = placeAmong(middle);
  int first = nodeAt(ivec3(corner.low)), y = air.cells, z = y * y;
  vec4 v[8] = vec4[8](centres[first], centres[first + 1], centres[first + y], centres[first + y + 1], centres[first + z],
                      centres[first + z + 1], centres[first + z + y], centres[first + z + y + 1]);
  return interpolated4(v, corner.part) * courant;
}

void main() {
  ivec3 c;
  if (!ownCell(c)) return;
  displacements[nodeAt(c)] = displacement(c, air.courant);
#if ONWARD
  onwards[nodeAt(c)] = displacement(c, -air.courant);
#endif
}
