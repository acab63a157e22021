// An invocation a cell, or a face of any component, of the wind grid; and what is sampled there. Needs air_settings.glsl.
#define INVOCATIONS 256
layout(local_size_x = INVOCATIONS) in;

// False past the last.
bool ownCell(out ivec3 c) {
  int n = int(gl_GlobalInvocationID.x);
  c = ivec3(n % air.cells, n / air.cells % air.cells, n / (air.cells * air.cells));
  return c.z < air.cells;
}
// False where there is none: past the last, or at places that the component does not have.
bool ownFace(out int axis, out ivec3 c) {
  int n = int(gl_GlobalInvocationID.x), side = air.cells + 1;
  axis = n / (side * side * side);
  c = ivec3(n % side, n / side % side, n / (side * side) % side);
  return axis < 3 && all(lessThan(c, ivec3(air.cells) + along(axis)));
}
ivec3 clampedCell(ivec3 c) { return clamp(c, ivec3(0), ivec3(air.cells - 1)); }
// Cells on both sides of a face, at the border the one that there is.
int cellBefore(int axis, ivec3 c) { return nodeAt(clampedCell(c - along(axis))); }
int cellAfter(ivec3 c) { return nodeAt(clampedCell(c)); }

vec3 middleOfFace(int axis, ivec3 c) {  // m, world
  return air.wind_box.xyz + (vec3(c) + 0.5 * vec3(1 - along(axis))) * air.wind_box.w;
}
// Beyond the grid's own box, half a cell out of the places of components that do not lie on its faces.
bool isBeyond(int axis, vec3 at) {
  vec3 low = -0.5 * vec3(1 - along(axis)), high = vec3(air.cells) + low;
  return any(lessThan(at, low)) || any(greaterThan(at, high));
}

struct Advected {
  float value, low, high;
};
#define ADVECTED(of, axis, at, result)                                                        \
  {                                                                                           \
    GridPlace corner = gridPlace(at, vec3(air.cells - 1) + vec3(along(axis)));                \
    int first = faceAt(axis, ivec3(corner.low)), y = air.cells + 1, z = y * y;                \
    float v[8] = float[8](of[first], of[first + 1], of[first + y], of[first + y + 1],         \
                          of[first + z], of[first + z + 1], of[first + z + y],                \
                          of[first + z + y + 1]);                                             \
    result = Advected(interpolated(v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7], corner.part), v[0], v[0]); \
    for (int n = 1; n < 8; ++n) {                                                             \
      result.low = min(result.low, v[n]);                                                     \
      result.high = max(result.high, v[n]);                                                   \
    }                                                                                         \
  }
