// Settings of the passes over the grids of hair and air, and the layout of the grids' arrays.
// Requires kernels/lanes_glsl.h and kernels/grid.h.
// Nodes of the hair grid and cells of the wind grid: x fastest, `cells` per axis. Faces of the wind grid: one array per
// velocity component, `cells` + 1 per axis; face i lies before cell i.
layout(std140, binding = 1) uniform Air {  // gpu_compute/air_layout.h
  vec4 hair_frame[3];                      // rows: from world, m, to indices of hair nodes
  vec4 turn[3];                            // rows: rotation from the hair grid's axes to the world's
  vec4 wind_of_hair[3];                    // rows: from indices of hair nodes to indices of the wind's cell centres
  vec4 wind_box;                           // xyz: low corner of the wind grid, m; w: edge of its cells, m
  vec4 ambient_mean;                       // xyz: mean ambient wind, m/s; w: turbulence, m/s
  vec4 ambient_carried;                    // xyz: corner of the turbulence box, m, in its axes; w: its cells per metre
  vec4 uniform_wind;                       // xyz: Parameters::wind, m/s; w: 1 - air_drag_along
  int cells;                               // per axis, of both grids
  int open_border;                         // 1, or 0 for walls
  int bodies;
  int sources;
  uint tiles;                     // sample tiles
  float seconds;                  // s, time step
  float courant;                  // s/m, time step / edge of the wind's cells
  float mass_scale;               // 1/kg, mass to fixed point
  float per_volume;               // 1/m^3, 1 / cell volume of the hair grid
  float mass;                     // kg, of all hair
  float stiffness;                // m^2/s^2, volume_stiffness within its limit of stability
  float gain;                     // volume_hold x time step
  float rest_scale;               // (1 + kDensityNoise) / volume_target
  float crowd_scale;              // mass x crowding to fixed point
  float slope;                    // s/m, see pushAlong()
  float friction;                 // fraction of the velocity that hair friction replaces by the mean, 0 to 1
  float alone;                    // 1/m^3, density at a sample of 1 kg by itself
  float exchange;                 // m^3/kg, time step x rate at which air takes on the hair's velocity, per density of hair
  float drag;                     // 1/s, rate at which a substep draws hair to the air
  int shift_x, shift_y, shift_z;  // cells by which the wind's box moves
  int spheres;                    // 1: some sources on the grid are spheres, and its border is open
}
air;

const float kWhole = 1073741824.0;  // of air/hair_layout.h, as the next
const float kMaxHeldCrowding = 3.0;

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
// Grid place of a point given in indices of nodes or cell centres.
GridPlace placeAmong(vec3 at) { return gridPlace(at, vec3(air.cells - 1)); }
vec4 interpolated4(vec4 v[8], vec3 part) {
  vec4 out_;
  for (int c = 0; c < 4; ++c)
    out_[c] = interpolated(v[0][c], v[1][c], v[2][c], v[3][c], v[4][c], v[5][c], v[6][c], v[7][c], part);
  return out_;
}
ivec3 cornerOf(int c) { return ivec3(c & 1, (c >> 1) & 1, c >> 2); }
