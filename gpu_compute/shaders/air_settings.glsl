// What the passes over grids are told, and where things lie on them. Needs kernels/lanes_glsl.h and kernels/grid.h.
// Nodes of hair and cells of air: x fastest, `cells` per axis. Faces: component after component, `cells` + 1 per axis, face i
// before cell i.
layout(std140, binding = 1) uniform Air {  // gpu_compute/air_layout.h
  vec4 hair_frame[3];    // world to hair nodes, rows
  vec4 turn[3];          // from the hair's axes to the world's, rows
  vec4 wind_of_hair[3];  // hair nodes to middles of the wind's cells, rows
  vec4 wind_box;         // low corner of the wind grid, m; w: its cell, m
  vec4 ambient_mean;     // m/s; w: turbulence, m/s
  vec4 ambient_carried;  // m, in the axes of the box of turbulence; w: cells of the box of turbulence per metre
  vec4 uniform_wind;     // m/s, the parameter; w: 1 - air_drag_along
  int cells;
  int open_border;       // 1, or 0 for walls
  int bodies;
  int sources;
  uint tiles;            // of samples
  float seconds;         // of the step
  float courant;         // seconds / the wind's cell
  float mass_scale;      // kg to whole numbers
  float per_volume;      // 1 / cell^3 of hair, 1/m^3
  float mass;            // kg, of all hair
  float stiffness;       // m^2/s^2
  float gain;            // volume_hold x seconds
  float rest_scale;      // 1 / volume_target
  float crowd_scale;     // mass x crowding to whole numbers
  float slope;           // see pushAlong
  float friction;        // part of the velocity that is drawn to the mean
  float alone;           // density that a sample of 1 kg makes where it is, 1/m^3
  float exchange;        // seconds x rate at which air takes on the hair's velocity, m^3/kg
  float drag;            // 1/s, at which a substep draws hair to the air
  int shift_x, shift_y, shift_z;  // cells that the wind's box moves by
  int spheres;           // 1 where some of the sources on the grid are, and its border is open
} air;

const float kWhole = 1073741824.0;  // air/hair_layout.h
const float kMostHeld = 3.0;

int nodeAt(ivec3 c) { return c.x + air.cells * (c.y + air.cells * c.z); }
int faceAt(int axis, ivec3 c) {
  int side = air.cells + 1;
  return c.x + side * (c.y + side * (c.z + side * axis));
}
bool isInside(ivec3 c) { return all(greaterThanEqual(c, ivec3(0))) && all(lessThan(c, ivec3(air.cells))); }
ivec3 along(int axis) { return ivec3(axis == 0 ? 1 : 0, axis == 1 ? 1 : 0, axis == 2 ? 1 : 0); }
vec3 transformed(vec4 rows[3], vec3 x) {
  return vec3(dot(rows[0].xyz, x), dot(rows[1].xyz, x), dot(rows[2].xyz, x)) + vec3(rows[0].w, rows[1].w, rows[2].w);
}
GridPlace placeAmong(vec3 at) { return gridPlace(at, vec3(air.cells - 1)); }
vec4 interpolated4(vec4 v[8], vec3 part) {
  vec4 out_;
  for (int c = 0; c < 4; ++c)
    out_[c] = interpolated(v[0][c], v[1][c], v[2][c], v[3][c], v[4][c], v[5][c], v[6][c], v[7][c], part);
  return out_;
}
ivec3 cornerOf(int c) { return ivec3(c & 1, (c >> 1) & 1, c >> 2); }
