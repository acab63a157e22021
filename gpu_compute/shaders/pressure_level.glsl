// A level of the pressure's multigrid (air/pressure.h): each cell against its six neighbours. The finest level has open and
// closed faces only, a word per cell; coarse ones have weights of faces. FINE: which it is. Needs kernels/lanes_glsl.h.
layout(std430, binding = 15) buffer Solve {
  uint fastest;       // bits of the largest component of velocity, m/s
  uint residual_now;  // bits of the largest residual, m/s, while it is found
  int done;
  int iterations;
  float residual;
  float products[2];  // dot(residual, its preconditioned self), of this iteration and the last
  int padding;
} solve;
layout(location = 0) uniform int level_cells;  // per axis

const float kFirstWeight = 1.0 / (1.25 + 0.75 * 0.70710678);  // air/wind.h
const float kSecondWeight = 1.0 / (1.25 - 0.75 * 0.70710678);

bool isOnLevel(ivec3 c) { return all(greaterThanEqual(c, ivec3(0))) && all(lessThan(c, ivec3(level_cells))); }
int levelAt(ivec3 c) { return c.x + level_cells * (c.y + level_cells * c.z); }

// What a cell's faces let through, x low, x high, y low, ...; and the inverse of their sum, 0 in solids.
struct Stencil {
  float open[6];
  float diagonal, inverse_diagonal;
};
#if FINE
// Bits 0 to 5: the faces are open; 6: solid.
layout(std430, binding = 0) readonly buffer Masks { uint masks[]; };
Stencil stencilOf(ivec3 c) {
  uint bits = isOnLevel(c) ? masks[levelAt(c)] : 0u;
  Stencil s;
  for (int face = 0; face < 6; ++face) s.open[face] = float((bits >> uint(face)) & 1u);
  s.diagonal = float(bitCount(bits & 63u));
  s.inverse_diagonal = s.diagonal > 0.0 ? 1.0 / s.diagonal : 0.0;
  return s;
}
#else
// Per place, of which there is one more per axis than cells: what the face before it lets through, of three components; and
// the inverse of the sum around the cell.
layout(std430, binding = 1) readonly buffer Weights { vec4 weights[]; };
layout(location = 1) uniform int first_weight;
Stencil stencilOf(ivec3 c) {
  Stencil s = Stencil(float[6](0.0, 0.0, 0.0, 0.0, 0.0, 0.0), 0.0, 0.0);
  if (!isOnLevel(c)) return s;
  int side = level_cells + 1, at = first_weight + c.x + side * (c.y + side * c.z);
  vec4 low = weights[at];
  s.open = float[6](low.x, weights[at + 1].x, low.y, weights[at + side].y, low.z, weights[at + side * side].z);
  for (int face = 0; face < 6; ++face) s.diagonal += s.open[face];
  s.inverse_diagonal = low.w;
  return s;
}
#endif

// Of an array whose places lie 1, y and z apart.
#define NEIGHBOURS(of, at, y, z, s)                                                                                    \
  madd(s.open[5], of[(at) + (z)],                                                                                      \
       madd(s.open[4], of[(at) - (z)],                                                                                 \
            madd(s.open[3], of[(at) + (y)],                                                                            \
                 madd(s.open[2], of[(at) - (y)], madd(s.open[1], of[(at) + 1], s.open[0] * of[(at) - 1])))))
#define RESIDUAL(of, at, y, z, s, right) ((right) - (s.diagonal * of[at] - NEIGHBOURS(of, at, y, z, s)))
