#version 450
// variants: CELLS=64 | CELLS=16 | CELLS=128
// Preconditioner, first half: transforms the residual's modes along x to modes along y and z, divides by the eigenvalues of
// the box without bodies, and transforms back along y and z. Also tests for convergence.
// Reads: modes of pressure_step.comp, matrices, eigenvalues, the largest residual.
// Writes: planes for pressure_correct.comp; iterations, residual and done of the solve.
// One workgroup per mode along x (x) and parity pair along y and z (y, 4 of them).
// CELLS: see pressure_solve.glsl.
#define INVOCATIONS 256
#define MATRICES (HALF <= 32 ? 4 : 1)
layout(local_size_x = INVOCATIONS) in;
#include "kernels/lanes_glsl.h"
#include "gpu_compute/shaders/pressure_solve.glsl"
layout(std430, binding = 10) readonly buffer Modes { float modes[]; };              // [mode along x][z][y]
layout(std430, binding = 11) readonly buffer Eigenvalues { float eigenvalues[]; };  // per mode of an axis
// [mode along x][parity of z][parity of y][z][y]; z and y over the lower half of cells.
layout(std430, binding = 12) writeonly buffer Planes { float planes[]; };

#define PITCH (HALF + 1)
shared float plane[HALF * PITCH];
shared int done_before;  // read once per workgroup: another workgroup may change solve.done meanwhile

// Multiplies the plane by `matrix` along y or z, in place. `held`: the matrix's block in matrix_rows, with HAS_ALL.
void transform(int matrix, int held, bool along_y) {
  int next = along_y ? 1 : PITCH, across = along_y ? PITCH : 1;
  int me = int(gl_LocalInvocationIndex), start = HAS_ALL ? held * HALF : 0;
  const int items = GROUPS * HALF, per_invocation = (items + INVOCATIONS - 1) / INVOCATIONS;
  vec4 found[per_invocation];
  for (int i = 0; i < per_invocation; ++i) found[i] = vec4(0);
  for (int from = 0; from < HALF; from += ROWS_AT_ONCE) {
    barrier();
    if (!HAS_ALL) {
      readRows(matrix, from, 0);
      barrier();
    }
    for (int i = 0; i < per_invocation; ++i) {
      int item = me + i * INVOCATIONS, at = item % HALF * across + from * next, group = item / HALF;
      if (item >= items) break;
      vec4 sum = found[i];
      for (int row = 0; row < ROWS_AT_ONCE; ++row)
        sum = fma(matrix_rows[(start + row) * GROUPS + group], vec4(plane[at + row * next]), sum);
      found[i] = sum;
    }
  }
  barrier();
  for (int i = 0; i < per_invocation; ++i) {
    int item = me + i * INVOCATIONS, at = item % HALF * across, group = item / HALF;
    if (item >= items) break;
    for (int n = 0; n < 4; ++n) plane[at + (4 * group + n) * next] = found[i][n];
  }
}

void main() {
  int me = int(gl_LocalInvocationIndex), mode = int(gl_WorkGroupID.x);
  if (me == 0) done_before = solve.done;
  barrier();
  if (done_before != 0) return;
  ivec2 parity = ivec2(gl_WorkGroupID.y & 1u, gl_WorkGroupID.y >> 1u);  // along y and z
  float residual = uintBitsToFloat(solve.residual_now);
  bool enough = !(residual > max(2e-4 * uintBitsToFloat(solve.fastest), 1e-6));  // kResidual, kStill of air/wind.h
  if (me == 0 && mode == 0 && gl_WorkGroupID.y == 0u) {
    solve.residual = residual;
    if (enough)
      solve.done = 1;
    else
      ++solve.iterations;
  }
  if (enough) return;
  ivec4 needed = ivec4(TO_MODES, TO_MODES, FROM_MODES, FROM_MODES) + ivec4(parity.x, parity.y, parity.y, parity.x);
  for (int n = 0; HAS_ALL && n < 4; ++n) readRows(needed[n], 0, n);
  float mirrored_y = parity.x == 0 ? 1.0 : -1.0, mirrored_z = parity.y == 0 ? 1.0 : -1.0;
  for (int n = me; n < HALF * HALF; n += INVOCATIONS) {
    int y = n % HALF, z = n / HALF, low = mode * CELLS * CELLS + CELLS * z, high = mode * CELLS * CELLS + CELLS * (CELLS - 1 - z);
    float before = modes[low + y] + mirrored_y * modes[low + CELLS - 1 - y];
    float behind = modes[high + y] + mirrored_y * modes[high + CELLS - 1 - y];
    plane[y + PITCH * z] = before + mirrored_z * behind;
  }
  transform(needed.x, 0, true);
  transform(needed.y, 1, false);
  barrier();
  for (int n = me; n < HALF * HALF; n += INVOCATIONS) {
    int y = n % HALF, z = n / HALF;
    float sum = eigenvalues[mode] + eigenvalues[parity.x * HALF + y] + eigenvalues[parity.y * HALF + z];
    plane[y + PITCH * z] *= sum > 0.0 ? inverse(sum) : 0.0;  // between walls the mean pressure is free: set to 0
  }
  transform(needed.z, 2, false);
  transform(needed.w, 3, true);
  barrier();
  int start = (4 * mode + int(gl_WorkGroupID.y)) * HALF * HALF;
  for (int n = me; n < HALF * HALF; n += INVOCATIONS) planes[start + n] = plane[n % HALF + PITCH * (n / HALF)];
}
