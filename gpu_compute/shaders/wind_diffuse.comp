#version 450
// variants: EXCHANGE=0 | EXCHANGE=1
// One explicit step of viscosity; values beyond the outermost faces equal those of the outermost faces.
// Reads: faces; with EXCHANGE the exchange of wind_exchange.comp. Writes: faces.
// One invocation per face.
// EXCHANGE: 0, 1: afterwards exchanges momentum with hair and sources, implicitly.
#include "kernels/lanes_glsl.h"
#include "kernels/grid.h"
#include "gpu_compute/shaders/air_settings.glsl"
#include "gpu_compute/shaders/wind_grid.glsl"
layout(std430, binding = 0) readonly buffer Faces { float faces[]; };
layout(std430, binding = 1) writeonly buffer Next { float next[]; };
layout(std430, binding = 5) readonly buffer Exchange { vec4 exchange[]; };  // see wind_exchange.comp
layout(location = 0) uniform float coefficient;                             // viscosity x time / cell^2; stable below 1/6

void main() {
  int axis;
  ivec3 c;
  if (!ownFace(axis, c)) return;
  int at = faceAt(axis, c);
  float own = faces[at], sum = 0.0;
  ivec3 last = ivec3(air.cells - 1) + along(axis);
  for (int other = 0; other < 3; ++other) {
    sum += faces[faceAt(axis, max(c - along(other), ivec3(0)))];
    sum += faces[faceAt(axis, min(c + along(other), last))];
  }
  float value = madd(sum - own * 6.0, coefficient, own);
#if EXCHANGE
  // Cells beyond the border exchange nothing.
  vec4 before = c[axis] > 0 ? exchange[cellBefore(axis, c)] : vec4(0);
  vec4 after = c[axis] < air.cells ? exchange[cellAfter(c)] : vec4(0);
  vec4 mean = (before + after) * 0.5;
  if (mean.w > 0.0) value = draggedTo(value, mean[axis] * inverse(max(mean.w, 1e-20)), mean.w);
#endif
  next[at] = value;
}
