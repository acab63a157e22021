#version 450
// variants: FIRST=1 CELLS=64 | FIRST=0 CELLS=64 | FIRST=0 CELLS=16 | FIRST=0 CELLS=128
// Step of the conjugate gradients; then the residual and its modes along x.
// The variant needs one reduction per iteration (Chronopoulos and Gear 1989, "s-step iterative methods for symmetric linear
// systems", section 3).
// Reads: corrections and their images, dot products of pressure_correct.comp; with FIRST the right-hand sides and masks.
// Writes: pressures, residuals, search direction and its image, modes along x, the largest residual.
// One workgroup per LINES lines of cells along x.
// FIRST: 0: takes a step.
//        1: no step: computes the residual of the given pressure.
// CELLS: see pressure_solve.glsl.
#define INVOCATIONS 512
#define MATRICES 2
layout(local_size_x = INVOCATIONS) in;
#include "kernels/lanes_glsl.h"
#include "gpu_compute/shaders/pressure_solve.glsl"
layout(std430, binding = 2) readonly buffer Rights { float rights[]; };  // right-hand sides, m/s
layout(std430, binding = 3) buffer Pressures { float pressures[]; };     // m/s, see projectVelocity()
layout(std430, binding = 4) buffer Residuals { float residuals[]; };
layout(std430, binding = 5) buffer Steps { float steps[]; };                       // the search direction
layout(std430, binding = 6) buffer Images { float images[]; };                     // the system's matrix x steps
layout(std430, binding = 7) readonly buffer Corrections { float corrections[]; };  // the preconditioned residuals
layout(std430, binding = 8) readonly buffer CorrectionImages { float correction_images[]; };
layout(std430, binding = 9) readonly buffer Products { vec2 partial_products[]; };  // see pressure_correct.comp
layout(std430, binding = 10) writeonly buffer Modes { float modes[]; };             // [mode along x][z][y]
layout(location = 0) uniform int tiles;                                             // number of partial_products
layout(location = 1) uniform int odd;                                               // 1: the number of earlier iterations is odd
layout(location = 2) uniform int first;  // 1: first iteration, there is no search direction yet

#define LINES 32
#define PITCH (LINES + 1)
shared float folded[CELLS * PITCH];  // sums of mirrored cells, then differences
shared uint largest;

// Updates a cell, and returns its residual. `turn`: coefficient of the old search direction; `length_`: step length.
float residualAt(int cell, float turn, float length_) {
#if FIRST
  const int y = CELLS, z = CELLS * CELLS;
  ivec3 c = ivec3(cell % y, cell / y % y, cell / z);
  Faces f = facesOf(masks[cell]);
  // Open faces of the border lead to a pressure of 0.
  float sum = 0.0;
  if (c.x > 0) sum = madd(f.low.x, pressures[cell - 1], sum);
  if (c.x + 1 < y) sum = madd(f.high.x, pressures[cell + 1], sum);
  if (c.y > 0) sum = madd(f.low.y, pressures[cell - y], sum);
  if (c.y + 1 < y) sum = madd(f.high.y, pressures[cell + y], sum);
  if (c.z > 0) sum = madd(f.low.z, pressures[cell - z], sum);
  if (c.z + 1 < y) sum = madd(f.high.z, pressures[cell + z], sum);
  float residual = rights[cell] - (f.open * pressures[cell] - sum);
#else
  float step_ = corrections[cell], image = correction_images[cell];
  if (first == 0) {
    step_ = madd(steps[cell], turn, step_);
    image = madd(images[cell], turn, image);
  }
  steps[cell] = step_;
  images[cell] = image;
  pressures[cell] = madd(step_, length_, pressures[cell]);
  float residual = madd(image, 0.0 - length_, residuals[cell]);
#endif
  residuals[cell] = residual;
  return residual;
}

void main() {
  if (solve.done != 0) return;
  int me = int(gl_LocalInvocationIndex), first_line = int(gl_WorkGroupID.x) * LINES;
  if (me == 0) largest = 0u;
  for (int parity = 0; parity < 2; ++parity) readRows(TO_MODES + parity, 0, parity);
  float turn = 0.0, length_ = 0.0;
#if !FIRST
  vec2 product = vec2(0);
  for (int n = me; n < tiles; n += INVOCATIONS) product += partial_products[n];
  product = sumOf(product);
  float curvature = product.y;
  if (first == 0 && solve.lengths[1 - odd] > 0.0) {
    turn = product.x / solve.products[1 - odd];
    curvature -= turn * product.x / solve.lengths[1 - odd];
  }
  if (curvature > 0.0) length_ = product.x / curvature;
  if (me == 0 && gl_WorkGroupID.x == 0u) {
    solve.products[odd] = product.x;
    solve.lengths[odd] = length_;
  }
#endif
  barrier();
  uint size = 0u;
  for (int n = me; n < HALF * LINES; n += INVOCATIONS) {
    int place = n % HALF, line = n / HALF, cell = CELLS * (first_line + line);
    float here = residualAt(cell + place, turn, length_), there = residualAt(cell + CELLS - 1 - place, turn, length_);
    size = max(size, max(floatBitsToUint(abs(here)), floatBitsToUint(abs(there))));
    folded[place * PITCH + line] = here + there;
    folded[(HALF + place) * PITCH + line] = here - there;
  }
  atomicMax(largest, size);
  barrier();
  if (me == 0) atomicMax(solve.residual_now, largest);
  const int items = 2 * GROUPS * LINES, per_invocation = (items + INVOCATIONS - 1) / INVOCATIONS;
  vec4 found[per_invocation];
  for (int i = 0; i < per_invocation; ++i) found[i] = vec4(0);
  for (int from = 0; from < HALF; from += ROWS_AT_ONCE) {
    if (from > 0) {
      barrier();
      for (int parity = 0; parity < 2; ++parity) readRows(TO_MODES + parity, from, parity);
      barrier();
    }
    for (int i = 0; i < per_invocation; ++i) {
      int item = me + i * INVOCATIONS, line = item % LINES, group = item / LINES % GROUPS, parity = item / (LINES * GROUPS);
      if (item >= items) break;
      vec4 sum = found[i];
      for (int row = 0; row < ROWS_AT_ONCE; ++row)
        sum = fma(matrix_rows[(parity * ROWS_AT_ONCE + row) * GROUPS + group],
                  vec4(folded[(parity * HALF + from + row) * PITCH + line]), sum);
      found[i] = sum;
    }
  }
  for (int i = 0; i < per_invocation; ++i) {
    int item = me + i * INVOCATIONS, line = item % LINES, group = item / LINES;  // groups of both parities
    if (item >= items) break;
    for (int n = 0; n < 4; ++n) modes[(4 * group + n) * CELLS * CELLS + first_line + line] = found[i][n];
  }
}
