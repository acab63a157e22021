#version 450
// Implicit momentum exchange with hair and sources for air that slips along hair: see draggedAmong() of kernels/grid.h.
// Reads: faces, exchange and slip of wind_exchange.comp. Writes: faces.
// One invocation per face.
#include "kernels/lanes_glsl.h"
#include "kernels/grid.h"
#include "gpu_compute/shaders/air_settings.glsl"
#include "gpu_compute/shaders/wind_grid.glsl"
layout(std430, binding = 0) readonly buffer Faces { float faces[]; };
layout(std430, binding = 1) writeonly buffer Next { float next[]; };
layout(std430, binding = 5) readonly buffer Exchange { vec4 exchange[]; };  // see wind_exchange.comp
struct CellSlip {
  vec4 first, last;  // symmetric matrix: xx, yy, zz, yz; xz, xy
};
layout(std430, binding = 10) readonly buffer Slip { CellSlip slip[]; };

// Mean of another velocity component over the cells on both sides of a face, m/s.
float componentBetween(int component, int axis, ivec3 c) {
  ivec3 before = clampedCell(c - along(axis)), after = clampedCell(c), onward = along(component);
  return 0.25 * (faces[faceAt(component, before)] + faces[faceAt(component, before + onward)] + faces[faceAt(component, after)] +
                 faces[faceAt(component, after + onward)]);
}

void main() {
  int axis;
  ivec3 c;
  if (!ownFace(axis, c)) return;
  float own = faces[faceAt(axis, c)];
  // Cells beyond the border exchange nothing.
  float before = c[axis] > 0 ? 0.5 : 0.0, after = c[axis] < air.cells ? 0.5 : 0.0;
  int cell_before = cellBefore(axis, c), cell_after = cellAfter(c);
  vec4 mean = exchange[cell_before] * before + exchange[cell_after] * after;
  if (mean.w > 0.0) {
    vec4 first = slip[cell_before].first * before + slip[cell_after].first * after;
    vec4 last = slip[cell_before].last * before + slip[cell_after].last * after;
    vec3 velocity;
    for (int other = 0; other < 3; ++other) velocity[other] = other == axis ? own : componentBetween(other, axis, c);
    own = draggedAmong(velocity, mean.xyz, mean.w, first.xyz, vec3(first.w, last.xy))[axis];
  }
  next[faceAt(axis, c)] = own;
}
