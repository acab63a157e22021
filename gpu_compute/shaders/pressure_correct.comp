#version 450
// variants: CELLS=64 | CELLS=16 | CELLS=128
// Preconditioner, second half: transforms back from modes along x to the preconditioned residual (the correction), and
// multiplies it by the pressure system's matrix, bodies included.
// Reads: planes of pressure_modes.comp, matrices, masks, residuals. Writes: corrections, their images under the system's
// matrix, and per workgroup the dot products of corrections with residuals and with images.
// One workgroup per bundle of OWN_Y x OWN_Z lines along x; it also computes the lines around them.
// CELLS: see pressure_solve.glsl.
#define INVOCATIONS 512
#define MATRICES 2
layout(local_size_x = INVOCATIONS) in;
#include "kernels/lanes_glsl.h"
#include "gpu_compute/shaders/pressure_solve.glsl"
layout(std430, binding = 4) readonly buffer Residuals { float residuals[]; };
layout(std430, binding = 7) writeonly buffer Corrections { float corrections[]; };
layout(std430, binding = 8) writeonly buffer CorrectionImages { float correction_images[]; };
// Per workgroup: dot products of corrections with residuals (x) and with images (y).
layout(std430, binding = 9) writeonly buffer Products { vec2 partial_products[]; };
layout(std430, binding = 12) readonly buffer Planes { float planes[]; };  // see pressure_modes.comp

// kBundleY and kBundleZ of gpu_compute/pressure_passes.cc.
#define OWN_Y (CELLS <= 96 ? 8 : 4)
#define OWN_Z 4
#define SIDE (OWN_Y + 2)
#define LINES (SIDE * (OWN_Z + 2))
#define PITCH (LINES | 1)
shared float values[CELLS * PITCH];  // per line: modes, later cells

void main() {
  if (solve.done != 0) return;
  int me = int(gl_LocalInvocationIndex);
  if (me == 0 && gl_WorkGroupID.x + gl_WorkGroupID.y == 0u) solve.residual_now = 0u;
  ivec2 first = ivec2(gl_WorkGroupID.xy) * ivec2(OWN_Y, OWN_Z) - 1;
  for (int parity = 0; parity < 2; ++parity) readRows(FROM_MODES + parity, 0, parity);
  for (int n = me; n < CELLS * LINES; n += INVOCATIONS) {
    int line = n % LINES, mode = n / LINES;
    ivec2 at = first + ivec2(line % SIDE, line / SIDE);
    float value = 0.0;
    if (all(greaterThanEqual(at, ivec2(0))) && all(lessThan(at, ivec2(CELLS)))) {
      ivec2 place = min(at, CELLS - 1 - at);
      float mirrored_y = at.x < HALF ? 1.0 : -1.0, mirrored_z = at.y < HALF ? 1.0 : -1.0;
      int from = 4 * mode * HALF * HALF + place.x + HALF * place.y;
      value = planes[from] + mirrored_y * planes[from + HALF * HALF] +
              mirrored_z * (planes[from + 2 * HALF * HALF] + mirrored_y * planes[from + 3 * HALF * HALF]);
    }
    values[mode * PITCH + line] = value;
  }
  const int items = GROUPS * LINES, per_invocation = (items + INVOCATIONS - 1) / INVOCATIONS;
  vec4 even[per_invocation], odd[per_invocation];
  for (int i = 0; i < per_invocation; ++i) even[i] = odd[i] = vec4(0);
  barrier();
  for (int from = 0; from < HALF; from += ROWS_AT_ONCE) {
    if (from > 0) {
      barrier();
      for (int parity = 0; parity < 2; ++parity) readRows(FROM_MODES + parity, from, parity);
      barrier();
    }
    for (int i = 0; i < per_invocation; ++i) {
      int item = me + i * INVOCATIONS, line = item % LINES, group = item / LINES;
      if (item >= items) break;
      vec4 sum = even[i], difference = odd[i];
      for (int row = 0; row < ROWS_AT_ONCE; ++row) {
        sum = fma(matrix_rows[row * GROUPS + group], vec4(values[(from + row) * PITCH + line]), sum);
        difference =
            fma(matrix_rows[(ROWS_AT_ONCE + row) * GROUPS + group], vec4(values[(HALF + from + row) * PITCH + line]), difference);
      }
      even[i] = sum;
      odd[i] = difference;
    }
  }
  barrier();
  for (int i = 0; i < per_invocation; ++i) {
    int item = me + i * INVOCATIONS, line = item % LINES, group = item / LINES;
    if (item >= items) break;
    for (int n = 0; n < 4; ++n) {
      int place = 4 * group + n;
      values[place * PITCH + line] = even[i][n] + odd[i][n];
      values[(CELLS - 1 - place) * PITCH + line] = even[i][n] - odd[i][n];
    }
  }
  barrier();
  vec2 product = vec2(0);
  for (int n = me; n < CELLS * OWN_Y * OWN_Z; n += INVOCATIONS) {
    int x = n % CELLS, y = n / CELLS % OWN_Y, z = n / (CELLS * OWN_Y);
    int cell = x + CELLS * (first.x + 1 + y + CELLS * (first.y + 1 + z)), at = x * PITCH + y + 1 + SIDE * (z + 1);
    Faces f = facesOf(masks[cell]);
    float own = f.open > 0.0 ? values[at] : 0.0, sum = 0.0;
    if (x > 0) sum = f.low.x * values[at - PITCH];
    if (x + 1 < CELLS) sum = madd(f.high.x, values[at + PITCH], sum);
    sum = madd(f.low.y, values[at - 1], sum);
    sum = madd(f.high.y, values[at + 1], sum);
    sum = madd(f.low.z, values[at - SIDE], sum);
    sum = madd(f.high.z, values[at + SIDE], sum);
    float image = f.open * own - sum;
    corrections[cell] = own;
    correction_images[cell] = image;
    product += own * vec2(residuals[cell], image);
  }
  product = sumOf(product);
  if (me == 0) partial_products[gl_WorkGroupID.x + gl_NumWorkGroups.x * gl_WorkGroupID.y] = product;
}
