#version 450
// variants: FORCES=1 AIR=2 RATES=0 ALONG=0 | FORCES=0 AIR=1 RATES=1 ALONG=1 | FORCES=1 AIR=0 RATES=0 ALONG=0 | FORCES=1 AIR=2 RATES=1 ALONG=1
// From the grids to an acceleration per vertex: what samples feel, then parts of that of the edges before and behind a vertex.
// FORCES: between hairs. AIR: 0 uniform, 1 as it blows with nothing in the way, 2 on the grid. RATES: vertices have drags of
// their own. ALONG: drag along strands is less.
#include "kernels/lanes_glsl.h"
#include "kernels/grid.h"
#include "gpu_compute/shaders/air_settings.glsl"
#include "gpu_compute/shaders/sample_tile.glsl"
#include "gpu_compute/shaders/hair_samples.glsl"
#include "gpu_compute/shaders/ambient.glsl"
layout(std430, binding = 7) readonly buffer Rates { float rates[]; };       // 1/s per vertex
layout(std430, binding = 8) writeonly buffer Guides { float guides[]; };    // 3 per vertex, m/s^2
layout(std430, binding = 11) readonly buffer Changes { vec4 changes[]; };   // m/s
layout(std430, binding = 12) readonly buffer Centres { vec4 centres[]; };   // m/s, of the wind's cells

// What samples feel. RATES: its parts, else only the acceleration that they come to.
#if RATES
#define VECTORS 3u
#else
#define VECTORS 1u
#endif
shared float of_samples[3u * VECTORS * uint(TILE_SAMPLES)];  // along strands
void put(uint vector, uint sample_, vec3 value) {
  for (uint c = 0u; c < 3u; ++c) of_samples[(3u * vector + c) * uint(TILE_SAMPLES) + sample_] = value[c];
}
vec3 got(uint vector, uint sample_) {
  uint at = 3u * vector * uint(TILE_SAMPLES) + sample_;
  return vec3(of_samples[at], of_samples[at + uint(TILE_SAMPLES)], of_samples[at + 2u * uint(TILE_SAMPLES)]);
}

struct Felt {
  vec3 pushed;    // m/s^2
  vec3 local;     // m/s, of the air beyond the uniform wind
  vec3 not_felt;  // m/s: x rate, see dragNotFelt
};

#define CORNERS(of)                                                                                          \
  vec4[8](of[first], of[first + 1], of[first + y], of[first + y + 1], of[first + z], of[first + z + 1], \
          of[first + z + y], of[first + z + y + 1])

bool isFinite(vec3 v) { return !any(isnan(v)) && !any(isinf(v)); }

// `root`: of its strand.
Felt feltBy(SampleTile tile, uint root, uint piece, uint sample_) {
  Felt felt = Felt(vec3(0), vec3(0), vec3(0));
  vec3 at = placeOf(sample_), motion = motionOf(sample_), wind = air.uniform_wind.xyz;
  int y = air.cells, z = y * y;
#if FORCES
  {
    GridPlace corner = placeAmong(at);
    int first = nodeAt(ivec3(corner.low));
    vec4 change = interpolated4(CORNERS(changes), corner.part);
    if (change.w != 0.0) change.xyz -= change.w * motion;
    felt.pushed = change.xyz * inverse(air.seconds);
  }
#endif
#if AIR == 2
  {
    GridPlace corner = placeAmong(transformed(air.wind_of_hair, at));
    int first = nodeAt(ivec3(corner.low));
    wind = interpolated4(CORNERS(centres), corner.part).xyz;
  }
#elif AIR == 1
  vec3 place = sampleOf(tile, root, piece).place;
  wind = ambientAt(place);
  for (int i = 0; i < air.sources; ++i) {
    vec3 blown;
    if (isBlown(sources[i], place, blown)) wind += blown;
  }
#endif
  felt.local = wind - air.uniform_wind.xyz;
#if ALONG
  felt.not_felt = dragNotFelt(wind - motion, directionOfPiece(chordOf(tile, root, piece)), 1.0, air.uniform_wind.w);
#endif
  // Of a strand that went wrong, or left the grid.
  if (!isFinite(felt.pushed + felt.local + felt.not_felt)) felt = Felt(vec3(0), vec3(0), vec3(0));
  return felt;
}

vec3 accelerationBy(Felt felt, float rate) {
  return madd(felt.local - felt.not_felt, rate, felt.pushed);
}
void keep(uint sample_, Felt felt) {
#if RATES
  put(0u, sample_, felt.pushed);
  put(1u, sample_, felt.local);
  put(2u, sample_, felt.not_felt);
#else
  put(0u, sample_, accelerationBy(felt, air.drag));
#endif
}
// By a vertex that has the drag `rate`.
vec3 accelerationOf(uint sample_, float rate) {
#if RATES
  return accelerationBy(Felt(got(0u, sample_), got(1u, sample_), got(2u, sample_)), rate);
#else
  return got(0u, sample_);
#endif
}
// What the samples of an edge come to, each as much as it has to do with the edge's end, or its start.
vec3 ofEdge(SampleTile tile, uint strand, uint edge, bool end, float rate) {
  uint first = strand * (tile.pieces + tile.margin) + pieceOfEdge(tile, edge) + tile.margin - tile.first_piece;
  if (tile.parts == 1u) return accelerationOf(first, rate);
  vec3 sum = vec3(0);
  for (uint part = 0u; part < tile.parts; ++part) {
    float along_edge = (float(part) + 0.5) / float(tile.parts), share = 2.0 / float(tile.parts);
    sum += accelerationOf(first + part, rate) * (share * (end ? along_edge : 1.0 - along_edge));
  }
  return sum;
}

void main() {
  if (workgroupNumber() >= air.tiles) return;
  SampleTile tile = tiles[workgroupNumber()];
  uint me = gl_LocalInvocationIndex, pieces = tile.pieces + tile.margin, first = workgroupNumber() * uint(TILE_SAMPLES);
  if (first + me == 0u) {  // for the next step
    fastest_before = fastest_now;
    fastest_now = 0u;
  }
  if (me < tile.pieces * tile.strands) {
    uint strand = order[first + me] & 0xFFFFu, piece = order[first + me] >> 16u;
    keep(strand * pieces + tile.margin + piece,
         feltBy(tile, roots[tile.first_strand + strand], tile.first_piece + piece, first + me));
  }
  if (tile.margin > 0u) {  // the last pieces of the tile before
    uint pieces_before = tiles[workgroupNumber() - 1u].pieces;
    for (uint n = me; n < pieces_before * tile.strands; n += uint(TILE_SAMPLES)) {
      uint from = first - uint(TILE_SAMPLES) + n, strand = order[from] & 0xFFFFu, piece = order[from] >> 16u;
      if (piece + tile.margin >= pieces_before)
        keep(strand * pieces + piece + tile.margin - pieces_before,
             feltBy(tile, roots[tile.first_strand + strand], tile.first_piece - pieces_before + piece, from));
    }
  }
  barrier();
  bool has_tips = tile.first_piece + tile.pieces == tile.pieces_of_strand;
  uint first_vertex = edgeOf(tile, tile.first_piece);
  uint vertices = edgeOf(tile, tile.first_piece + tile.pieces) + (has_tips ? 1u : 0u) - first_vertex;
  for (uint n = me; n < vertices * tile.strands; n += uint(TILE_SAMPLES)) {
    uvec2 at = divided(n, vertices);  // strand and vertex
    uint strand = at.x, edge = first_vertex + at.y, vertex = roots[tile.first_strand + strand] + edge;
    float before = edge > 0u ? edge_masses[vertex - 1u].y : 0.0, behind = edge < tile.edges ? edge_masses[vertex].x : 0.0;
#if RATES
    float rate = rates[vertex];
#else
    float rate = air.drag;
#endif
    float per_mass = inverse(max(before + behind, 1e-30));
    vec3 sum = vec3(0);
    if (before > 0.0) sum += ofEdge(tile, strand, edge - 1u, true, rate) * (before * per_mass);
    if (behind > 0.0) sum += ofEdge(tile, strand, edge, false, rate) * (behind * per_mass);
    guides[3u * vertex] = sum.x;
    guides[3u * vertex + 1u] = sum.y;
    guides[3u * vertex + 2u] = sum.z;
  }
}
