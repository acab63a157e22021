// Indexing and sampling of the wind grid, for passes with one invocation per cell or per face. Requires air_settings.glsl.
#define INVOCATIONS 256
layout(local_size_x = INVOCATIONS) in;

// The cell of this invocation; false past the last cell.
bool ownCell(out ivec3 c) {
  int n = int(gl_GlobalInvocationID.x);
  c = ivec3(n % air.cells, n / air.cells % air.cells, n / (air.cells * air.cells));
  return c.z < air.cells;
}
// The face of this invocation: velocity component and indices. False past the last face, or for indices that the component
// does not have.
bool ownFace(out int axis, out ivec3 c) {
  int n = int(gl_GlobalInvocationID.x), side = air.cells + 1;
  axis = n / (side * side * side);
  c = ivec3(n % side, n / side % side, n / (side * side) % side);
  return axis < 3 && all(lessThan(c, ivec3(air.cells) + along(axis)));
}
ivec3 clampedCell(ivec3 c) { return clamp(c, ivec3(0), ivec3(air.cells - 1)); }
// Indices of the cells before and after a face; at the border both are the one cell there.
int cellBefore(int axis, ivec3 c) { return nodeAt(clampedCell(c - along(axis))); }
int cellAfter(ivec3 c) { return nodeAt(clampedCell(c)); }

vec3 middleOfFace(int axis, ivec3 c) {  // m, world
  return air.wind_box.xyz + (vec3(c) + 0.5 * vec3(1 - along(axis))) * air.wind_box.w;
}
// Whether a position, in indices of the component's faces, is outside the grid's box. Across the other axes the box reaches
// half a cell beyond the component's outermost faces.
bool isBeyond(int axis, vec3 at) {
  vec3 low = -0.5 * vec3(1 - along(axis)), high = vec3(air.cells) + low;
  return any(lessThan(at, low)) || any(greaterThan(at, high));
}

// An interpolated component, and the least and the greatest of the values that it was interpolated from, m/s.
struct Advected {
  float value, low, high;
};
#define ADVECTED(of, axis, at, result)                                                                                  \
  {                                                                                                                     \
    GridPlace corner = gridPlace(at, vec3(air.cells - 1) + vec3(along(axis)));                                          \
    int first = faceAt(axis, ivec3(corner.low)), y = air.cells + 1, z = y * y;                                          \
    float v[8] = float[8](of[first], of[first + 1], of[first + y], of[first + y + 1], of[first + z], of[first + z + 1], \
                          of[first + z + y], of[first + z + y + 1]);                                                    \
    result = Advected(interpolated(v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7], corner.part), v[0], v[0]);           \
    for (int n = 1; n < 8; ++n) {                                                                                       \
      result.low = min(result.low, v[n]);                                                                               \
      result.high = max(result.high, v[n]);                                                                             \
    }                                                                                                                   \
  }
