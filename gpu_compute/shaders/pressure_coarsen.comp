#version 450
// variants: FINE=1 | FINE=0
// Weights of a level from the next finer one: a coarse face lets through what its four faces do, over twice the way. FINE:
// the finer one is the finest; `level_cells` is of the finer one.
#define INVOCATIONS 256
layout(local_size_x = INVOCATIONS) in;
#include "kernels/lanes_glsl.h"
#include "gpu_compute/shaders/pressure_level.glsl"
layout(std430, binding = 2) writeonly buffer CoarseWeights { vec4 coarse_weights[]; };
layout(location = 2) uniform int first_coarse;

// Of the face of a component before a cell of the finer level, or behind its last one.
float openBefore(int axis, ivec3 c) {
  bool behind = c[axis] == level_cells;
  if (behind) c[axis] -= 1;
  return stencilOf(c).open[2 * axis + (behind ? 1 : 0)];
}
float openOf(int axis, ivec3 coarse) {
  ivec3 c = 2 * coarse, u = ivec3(axis == 2 ? 1 : 0, axis == 0 ? 1 : 0, axis == 1 ? 1 : 0), v = u.zxy;
  return 0.5 * (openBefore(axis, c) + openBefore(axis, c + u) + openBefore(axis, c + v) + openBefore(axis, c + u + v));
}

void main() {
  int m = level_cells / 2, side = m + 1, n = int(gl_GlobalInvocationID.x);
  ivec3 c = ivec3(n % side, n / side % side, n / (side * side));
  if (c.z > m) return;
  vec4 out_ = vec4(0);
  float sum = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    ivec3 others = ivec3(axis == 0 ? 0 : c.x, axis == 1 ? 0 : c.y, axis == 2 ? 0 : c.z);
    if (any(greaterThanEqual(others, ivec3(m)))) continue;
    out_[axis] = openOf(axis, c);
    ivec3 next = c;
    next[axis] += 1;
    if (c[axis] < m) sum += out_[axis] + openOf(axis, next);
  }
  if (all(lessThan(c, ivec3(m))) && sum > 0.0) out_.w = 1.0 / sum;
  coarse_weights[first_coarse + n] = out_;
}
