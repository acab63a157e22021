// The samples of a workgroup (gpu_compute/hair_passes.h), which represent the pieces of strands on the grid
// (air/hair_layout.h). Vertices are stored along strands; samples are stored so that neighbours in space are adjacent,
// often the same piece of the next strand. Requires air_settings.glsl.
#define TILE_SAMPLES 320  // kTileSamples
layout(local_size_x = TILE_SAMPLES) in;
layout(std430, binding = 0) readonly buffer Positions { vec4 positions[]; };    // xyz, m, world
layout(std430, binding = 1) readonly buffer Velocities { vec4 velocities[]; };  // xyz, m/s
struct SampleTile {                                                             // gpu_compute/hair_passes.h
  uint first_strand, strands, first_piece, pieces;
  uint edges, pieces_of_strand, parts, margin;
};
layout(std430, binding = 2) readonly buffer Tiles { SampleTile tiles[]; };
layout(std430, binding = 3) readonly buffer Roots { uint roots[]; };   // first vertex of each strand, in the order of tiles
layout(std430, binding = 10) readonly buffer Order { uint order[]; };  // per sample: strand + 65536 x piece, of the tile
layout(std430, binding = 4) readonly buffer EdgeMasses { vec2 edge_masses[]; };  // kg, at the edge's start and end; 0 at tips

// Results of hair_splat.comp, in three planes (x, y, z) of all samples: positions in indices of hair nodes, negative for
// invalid samples; velocities, m/s.
layout(std430, binding = 5) buffer Places { float places[]; };
layout(std430, binding = 9) buffer Motions { float motions[]; };

uint workgroupNumber() { return gl_WorkGroupID.x + gl_NumWorkGroups.x * gl_WorkGroupID.y; }

// First edge of a piece, counted from the strand's first edge.
uint edgeOf(SampleTile tile, uint piece) {
  if (tile.parts > 1u) return piece / tile.parts;
  return tile.pieces_of_strand == tile.edges ? piece : piece * tile.edges / tile.pieces_of_strand;
}
// Piece of an edge; of an edge in several parts, the piece of its first part.
uint pieceOfEdge(SampleTile tile, uint edge) {
  if (tile.parts > 1u) return edge * tile.parts;
  return tile.pieces_of_strand == tile.edges ? edge : ((edge + 1u) * tile.pieces_of_strand - 1u) / tile.edges;
}

// Centre of mass of a piece, m, extrapolated by extrapolationShare() of the step; its mean velocity, m/s; its mass, kg.
struct Sample {
  vec3 place, motion;
  float mass;
};
vec3 placeAhead(vec3 place, vec3 motion) { return madd(motion, extrapolationShare() * air.seconds, place); }
// `root`: first vertex of the piece's strand.
Sample sampleOf(SampleTile tile, uint root, uint piece) {
  uint first = root + edgeOf(tile, piece), last = tile.parts > 1u ? first + 1u : root + edgeOf(tile, piece + 1u);
  // The piece's shares of the edge's mass at its start and its end.
  vec2 share = vec2(1);
  if (tile.parts > 1u) {
    float at = (float(piece % tile.parts) + 0.5) / float(tile.parts);
    share = vec2(1.0 - at, at) * (2.0 / float(tile.parts));
  }
  vec3 x = positions[first].xyz, u = velocities[first].xyz;
  Sample sum = Sample(vec3(0), vec3(0), 0.0);
  for (uint v = first; v < last; ++v) {
    vec3 x_next = positions[v + 1u].xyz, u_next = velocities[v + 1u].xyz;
    vec2 ends = edge_masses[v] * share;
    float m = ends.x + ends.y, at = ends.y * inverse(max(m, 1e-30));
    sum.mass += m;
    vec3 middle = madd(x_next - x, at, x), mean = madd(u_next - u, at, u);
    if (last == first + 1u) return Sample(placeAhead(middle, mean), mean, m);
    sum.place = madd(middle, m, sum.place);
    sum.motion = madd(mean, m, sum.motion);
    x = x_next;
    u = u_next;
  }
  float per_mass = inverse(max(sum.mass, 1e-30));
  vec3 mean = sum.motion * per_mass;
  return Sample(placeAhead(sum.place * per_mass, mean), mean, sum.mass);
}

// Vector from a piece's first vertex to its last, m. `root`: first vertex of its strand.
vec3 chordOf(SampleTile tile, uint root, uint piece) {
  uint first = root + edgeOf(tile, piece), last = tile.parts > 1u ? first + 1u : root + edgeOf(tile, piece + 1u);
  return positions[last].xyz - positions[first].xyz;
}

uint plane() { return air.tiles * uint(TILE_SAMPLES); }
vec3 placeOf(uint at) { return vec3(places[at], places[plane() + at], places[2u * plane() + at]); }
vec3 motionOf(uint at) { return vec3(motions[at], motions[plane() + at], motions[2u * plane() + at]); }

// n / by and n % by, in floating point; exact for numbers as small as a workgroup's.
uvec2 divided(uint n, uint by) {
  uint whole = uint((float(n) + 0.5) / float(by));
  return uvec2(whole, n - whole * by);
}
