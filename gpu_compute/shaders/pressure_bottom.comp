#version 450
// The coarse levels of a V-cycle, 16 cells per axis and fewer, in one workgroup; and whether the residual that it began with
// is small enough.
#define INVOCATIONS 1024
#define PER_INVOCATION 4
layout(local_size_x = INVOCATIONS) in;
#define FINE 0
#include "kernels/lanes_glsl.h"
#include "gpu_compute/shaders/pressure_level.glsl"
layout(std430, binding = 2) readonly buffer Rights { float rights[]; };
layout(std430, binding = 11) writeonly buffer Results { float results[]; };
layout(location = 2) uniform int levels;  // 1 to 3
layout(location = 3) uniform int coarsest_sweeps;  // pairs

// Levels one after the other.
#define SECOND 4096
#define THIRD (4096 + 512)
shared float values[4096 + 512 + 64];
shared float coarse_rights[512 + 64];
float fresh[PER_INVOCATION];

int level = 0;
int cellsOf(int of) { return level_cells >> of; }
int startOf(int of) { return of == 0 ? 0 : of == 1 ? SECOND : THIRD; }
int weightsOf(int of) {
  int at = first_weight;
  for (int l = 0; l < of; ++l) at += (cellsOf(l) + 1) * (cellsOf(l) + 1) * (cellsOf(l) + 1);
  return at;
}
float rightOf(int n) { return level == 0 ? rights[n] : coarse_rights[startOf(level) - SECOND + n]; }

// Sum of what neighbours let through, diagonal, and its inverse of cell n of the level.
vec3 rowOf(int n) {
  int m = cellsOf(level), side = m + 1;
  ivec3 c = ivec3(n % m, n / m % m, n / (m * m));
  int at = weightsOf(level) + c.x + side * (c.y + side * c.z), own = startOf(level) + n;
  vec4 low = weights[at];
  float open_x = weights[at + 1].x, open_y = weights[at + side].y, open_z = weights[at + side * side].z;
  float sum = 0.0;
  if (c.x > 0) sum = madd(low.x, values[own - 1], sum);
  if (c.x + 1 < m) sum = madd(open_x, values[own + 1], sum);
  if (c.y > 0) sum = madd(low.y, values[own - m], sum);
  if (c.y + 1 < m) sum = madd(open_y, values[own + m], sum);
  if (c.z > 0) sum = madd(low.z, values[own - m * m], sum);
  if (c.z + 1 < m) sum = madd(open_z, values[own + m * m], sum);
  return vec3(sum, low.x + open_x + low.y + open_y + low.z + open_z, low.w);
}
float residualOf(int n) {
  vec3 row = rowOf(n);
  return rightOf(n) - (row.y * values[startOf(level) + n] - row.x);
}

void startFromNothing() {
  int me = int(gl_LocalInvocationIndex), m = cellsOf(level), side = m + 1;
  for (int n = me; n < m * m * m; n += INVOCATIONS) {
    int at = weightsOf(level) + n % m + side * (n / m % m + side * (n / (m * m)));
    values[startOf(level) + n] = kFirstWeight * weights[at].w * rightOf(n);
  }
  barrier();
}
void smooth_(float weight) {
  int me = int(gl_LocalInvocationIndex), m = cellsOf(level), count = m * m * m;
  for (int i = 0; i < PER_INVOCATION; ++i) {
    int n = me + INVOCATIONS * i;
    if (n >= count) break;
    vec3 row = rowOf(n);
    float own = values[startOf(level) + n];
    fresh[i] = madd(weight * row.z, rightOf(n) - (row.y * own - row.x), own);
  }
  barrier();
  for (int i = 0; i < PER_INVOCATION; ++i) {
    int n = me + INVOCATIONS * i;
    if (n < count) values[startOf(level) + n] = fresh[i];
  }
  barrier();
}

void main() {
  if (solve.done != 0) return;
  int me = int(gl_LocalInvocationIndex);
  uint residual = solve.residual_now;
  float limit = max(2e-4 * uintBitsToFloat(solve.fastest), 1e-6);  // air/wind.h: kResidual, kStill
  bool enough = !(uintBitsToFloat(residual) > limit);
  barrier();
  if (me == 0) {
    solve.residual = uintBitsToFloat(residual);
    solve.residual_now = 0u;
    if (enough) solve.done = 1;
    else ++solve.iterations;
  }
  if (enough) return;
  for (level = 0; level + 1 < levels; ++level) {
    startFromNothing();
    smooth_(kSecondWeight);
    int m = cellsOf(level), half_ = cellsOf(level + 1), coarse = startOf(level + 1) - SECOND;
    for (int n = me; n < half_ * half_ * half_; n += INVOCATIONS) {
      ivec3 c = 2 * ivec3(n % half_, n / half_ % half_, n / (half_ * half_));
      float sum = 0.0;
      for (int corner = 0; corner < 8; ++corner) {
        ivec3 fine = c + ivec3(corner & 1, (corner >> 1) & 1, corner >> 2);
        sum += residualOf(fine.x + m * (fine.y + m * fine.z));
      }
      coarse_rights[coarse + n] = sum;
    }
    barrier();
  }
  startFromNothing();
  for (int pair = 0; pair < coarsest_sweeps; ++pair) {
    if (pair > 0) smooth_(pair % 2 == 0 ? kFirstWeight : kSecondWeight);
    smooth_(pair % 2 == 0 ? kSecondWeight : kFirstWeight);
  }
  for (--level; level >= 0; --level) {
    int m = cellsOf(level), half_ = cellsOf(level + 1), side = m + 1;
    for (int n = me; n < m * m * m; n += INVOCATIONS) {
      ivec3 c = ivec3(n % m, n / m % m, n / (m * m)), coarse = c / 2;
      float add = values[startOf(level + 1) + coarse.x + half_ * (coarse.y + half_ * coarse.z)];
      if (weights[weightsOf(level) + c.x + side * (c.y + side * c.z)].w > 0.0) values[startOf(level) + n] += add;
    }
    barrier();
    smooth_(kSecondWeight);
    smooth_(kFirstWeight);
  }
  for (int n = me; n < level_cells * level_cells * level_cells; n += INVOCATIONS) results[n] = values[n];
}
