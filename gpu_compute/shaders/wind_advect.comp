#version 450
// variants: CORRECT=0 | CORRECT=1
// Semi-Lagrangian advection of face velocities. Reads: faces, displacements of wind_displace.comp. Writes: advected faces.
// One invocation per face.
// CORRECT: 0: advects.
//          1: MacCormack's correction of the advected velocities in `ahead`; also reads onwards.
#include "kernels/lanes_glsl.h"
#include "kernels/grid.h"
#include "gpu_compute/shaders/air_settings.glsl"
#include "gpu_compute/shaders/ambient.glsl"
#include "gpu_compute/shaders/wind_grid.glsl"
layout(std430, binding = 0) readonly buffer Faces { float faces[]; };  // m/s
layout(std430, binding = 1) writeonly buffer Next { float next[]; };
layout(std430, binding = 3) readonly buffer Displacements { vec4 displacements[]; };
layout(std430, binding = 4) readonly buffer Onwards { vec4 onwards[]; };
layout(std430, binding = 5) readonly buffer Ahead { float ahead[]; };  // faces advected once, m/s

void main() {
  int axis;
  ivec3 c;
  if (!ownFace(axis, c)) return;
  int before = cellBefore(axis, c), after = cellAfter(c);
  vec3 behind = vec3(c) - (displacements[before].xyz + displacements[after].xyz) * 0.5;
  bool beyond = air.open_border != 0 && isBeyond(axis, behind);
  Advected from;
  ADVECTED(faces, axis, behind, from)
#if CORRECT
  vec3 onward = vec3(c) - (onwards[before].xyz + onwards[after].xyz) * 0.5;
  Advected back;
  ADVECTED(ahead, axis, onward, back)
  int at = faceAt(axis, c);
  beyond = beyond || (air.open_border != 0 && isBeyond(axis, onward));
  next[at] = beyond ? ahead[at] : macCormack(ahead[at], faces[at], back.value, from.low, from.high);
#else
  float value = from.value;
  if (beyond) {
    vec3 low = 0.5 * vec3(1 - along(axis));
    value = ambientAt(air.wind_box.xyz + (behind + low) * air.wind_box.w)[axis];
  }
  next[faceAt(axis, c)] = value;
#endif
}
