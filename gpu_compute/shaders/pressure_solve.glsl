// Shared by the passes of the pressure solve (gpu_compute/pressure_passes.h).
// Modes along an axis are even (parity 0) or odd (parity 1) about its middle, HALF modes each. A transform of one parity
// needs only the sums, or the differences, of mirrored cells. Mode numbers are parity * HALF + number.
// CELLS: cells per axis, 16 to 128, a multiple of 16.
// INVOCATIONS: invocations per workgroup, a power of 2. MATRICES: transform matrices that a pass holds in shared memory.
#define HALF (CELLS / 2)
#define GROUPS (HALF / 4)  // groups of four modes or cells; one invocation computes a group
layout(std430, binding = 15) buffer Solve {
  uint fastest;       // largest velocity component, m/s, as bits of a float
  uint residual_now;  // largest residual, m/s, as bits of a float, while pressure_step.comp computes it
  int done;           // 1: converged; later passes return at once
  int iterations;     // so far
  float residual;     // largest residual of the last iteration, m/s
  float products[2];  // dot(residual, preconditioned residual), of even and odd iterations
  float lengths[2];   // step lengths of even and odd iterations
}
solve;
// Per cell. Bits 0 to 5: low x, high x, low y, high y, low z, high z face is open; bit 6: solid.
layout(std430, binding = 0) readonly buffer Masks { uint masks[]; };

// Four HALF x HALF matrices: to modes, parity 0 and 1; from modes, parity 0 and 1. One row per input.
layout(std430, binding = 1) readonly buffer Matrices { vec4 matrices[]; };
#define TO_MODES 0
#define FROM_MODES 2
// Matrix rows held in shared memory at a time: whole matrices, up to HALF 32, or 8 rows of each.
#define HAS_ALL (HALF <= 32)
#define ROWS_AT_ONCE (HAS_ALL ? HALF : 8)
shared vec4 matrix_rows[MATRICES * ROWS_AT_ONCE * GROUPS];
// Reads ROWS_AT_ONCE rows of `matrix`, from row `first` on, to block `to` of matrix_rows. No barrier.
void readRows(int matrix, int first, int to) {
  for (int n = int(gl_LocalInvocationIndex); n < ROWS_AT_ONCE * GROUPS; n += INVOCATIONS)
    matrix_rows[to * ROWS_AT_ONCE * GROUPS + n] = matrices[matrix * HALF * GROUPS + first * GROUPS + n];
}

// Open faces of a cell, 1 or 0 per axis, and their number.
struct Faces {
  vec3 low, high;
  float open;
};
Faces facesOf(uint bits) {
  uvec3 at = uvec3(bits) >> uvec3(0, 2, 4);
  return Faces(vec3(at & 1u), vec3((at >> 1u) & 1u), float(bitCount(bits & 63u)));
}

// Sum over all invocations of a workgroup, in a fixed order, so that results are reproducible.
shared vec2 summed[INVOCATIONS];
vec2 sumOf(vec2 value) {
  int me = int(gl_LocalInvocationIndex);
  barrier();
  summed[me] = value;
  for (int half_ = INVOCATIONS / 2; half_ > 0; half_ /= 2) {
    barrier();
    if (me < half_) summed[me] += summed[me + half_];
  }
  barrier();
  return summed[0];
}
