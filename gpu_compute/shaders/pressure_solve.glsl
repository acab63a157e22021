// What the passes of the pressure (gpu_compute/pressure_passes.h) share. CELLS: per axis, known when they are compiled.
// Modes along an axis are even or odd about its middle, so that each half of them needs only the sums, or the differences, of
// places that mirror each other: parity 0 and 1, HALF modes each. Mode numbers are parity * HALF + number.
#define HALF (CELLS / 2)
#define GROUPS (HALF / 4)  // modes or places that one invocation finds together
layout(std430, binding = 15) buffer Solve {
  uint fastest;       // bits of the largest component of velocity, m/s
  uint residual_now;  // bits of the largest residual, m/s, while it is found
  int done;
  int iterations;
  float residual;
  float products[2];  // dot(residual, its preconditioned self), of this iteration and the last
  float lengths[2];   // of steps, likewise
} solve;
layout(std430, binding = 0) readonly buffer Masks { uint masks[]; };  // bits 0 to 5: the cell's faces are open; 6: solid

// Matrices of HALF x HALF: to modes, parity 0 and 1; back from modes, parity 0 and 1. What comes in row after row.
layout(std430, binding = 1) readonly buffer Matrices { vec4 matrices[]; };
#define TO_MODES 0
#define FROM_MODES 2
// As many rows of them at once as shared memory has room for: all of them, of all MATRICES that a pass needs, or a few.
#define HAS_ALL (HALF <= 32)
#define ROWS_AT_ONCE (HAS_ALL ? HALF : 8)
shared vec4 matrix_rows[MATRICES * ROWS_AT_ONCE * GROUPS];
void readRows(int matrix, int first, int to) {
  for (int n = int(gl_LocalInvocationIndex); n < ROWS_AT_ONCE * GROUPS; n += INVOCATIONS)
    matrix_rows[to * ROWS_AT_ONCE * GROUPS + n] = matrices[matrix * HALF * GROUPS + first * GROUPS + n];
}

// Bits 0 to 5 of a cell as numbers, and how many there are.
struct Faces {
  vec3 low, high;
  float open;
};
Faces facesOf(uint bits) {
  uvec3 at = uvec3(bits) >> uvec3(0, 2, 4);
  return Faces(vec3(at & 1u), vec3((at >> 1u) & 1u), float(bitCount(bits & 63u)));
}

// Sums over all invocations of a workgroup, in an order that is always the same.
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
