#version 450
// variants: FORCES=1 AIR=2 RATES=0 ALONG=0 | FORCES=0 AIR=1 RATES=1 ALONG=1 | FORCES=1 AIR=0 RATES=0 ALONG=0 | FORCES=1 AIR=2 RATES=1 ALONG=1
// External accelerations of vertices from the grids. First of samples; then each vertex gets the means over the samples of
// the edges before and after it, weighted by mass.
// Reads: samples, changes of hair_forces.comp, cell-centre velocities of the wind grid or ambient wind and sources.
// Writes: an acceleration per vertex, m/s^2; rotates the largest velocities of hair_samples.glsl for the next step.
// One workgroup per tile of samples; one invocation per sample, then per vertex.
// FORCES: 0, 1: there are forces between hairs.
// AIR: 0: uniform wind. 1: ambient wind and sources, unobstructed. 2: wind grid.
// RATES: 0, 1: each vertex has its own drag rate.
// ALONG: 0, 1: drag along strands is less than across.
#include "kernels/lanes_glsl.h"
#include "kernels/grid.h"
#include "gpu_compute/shaders/air_settings.glsl"
#include "gpu_compute/shaders/sample_tile.glsl"
#include "gpu_compute/shaders/hair_samples.glsl"
#include "gpu_compute/shaders/ambient.glsl"
layout(std430, binding = 7) readonly buffer Rates { float rates[]; };      // 1/s per vertex
layout(std430, binding = 8) writeonly buffer Guides { float guides[]; };   // 3 per vertex, m/s^2
layout(std430, binding = 11) readonly buffer Changes { vec4 changes[]; };  // m/s
layout(std430, binding = 12) readonly buffer Centres { vec4 centres[]; };  // m/s, at centres of the wind's cells

// Vectors stored per sample: with RATES the parts of AirForce, else the acceleration that they sum to.
#if RATES
#define VECTORS 3u
#else
#define VECTORS 1u
#endif
shared float of_samples[3u * VECTORS * uint(TILE_SAMPLES)];  // samples in the order along strands
void put(uint vector, uint sample_, vec3 value) {
  for (uint c = 0u; c < 3u; ++c) of_samples[(3u * vector + c) * uint(TILE_SAMPLES) + sample_] = value[c];
}
vec3 got(uint vector, uint sample_) {
  uint at = 3u * vector * uint(TILE_SAMPLES) + sample_;
  return vec3(of_samples[at], of_samples[at + uint(TILE_SAMPLES)], of_samples[at + 2u * uint(TILE_SAMPLES)]);
}

struct AirForce {
  vec3 pushed;     // m/s^2, by forces between hairs
  vec3 local;      // m/s, velocity of the air less the uniform wind, which the solver applies itself
  vec3 slip_drag;  // m/s; times the drag rate: see slipDragLoss()
};

#define CORNERS(of)                                                                                                        \
  vec4[8](of[first], of[first + 1], of[first + y], of[first + y + 1], of[first + z], of[first + z + 1], of[first + z + y], \
          of[first + z + y + 1])

bool isFinite(vec3 v) { return !any(isnan(v)) && !any(isinf(v)); }

// `root`: first vertex of the sample's strand.
AirForce airForceOn(SampleTile tile, uint root, uint piece, uint sample_) {
  AirForce air_force = AirForce(vec3(0), vec3(0), vec3(0));
  vec3 at = placeOf(sample_), motion = motionOf(sample_), wind = air.uniform_wind.xyz;
  int y = air.cells, z = y * y;
#if FORCES
  {
    GridPlace corner = placeAmong(at);
    int first = nodeAt(ivec3(corner.low));
    vec4 change = interpolated4(CORNERS(changes), corner.part);
    if (change.w != 0.0) change.xyz -= change.w * motion;
    air_force.pushed = change.xyz * inverse(air.seconds);
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
  air_force.local = wind - air.uniform_wind.xyz;
#if ALONG
  air_force.slip_drag = slipDragLoss(wind - motion, directionOfPiece(chordOf(tile, root, piece)), 1.0, air.uniform_wind.w);
#endif
  // Not finite: the strand diverged or left the grid.
  if (!isFinite(air_force.pushed + air_force.local + air_force.slip_drag)) air_force = AirForce(vec3(0), vec3(0), vec3(0));
  return air_force;
}

// Acceleration, m/s^2, at a drag rate in 1/s.
vec3 accelerationBy(AirForce air_force, float rate) {
  return madd(air_force.local - air_force.slip_drag, rate, air_force.pushed);
}
void keep(uint sample_, AirForce air_force) {
#if RATES
  put(0u, sample_, air_force.pushed);
  put(1u, sample_, air_force.local);
  put(2u, sample_, air_force.slip_drag);
#else
  put(0u, sample_, accelerationBy(air_force, air.drag));
#endif
}
// Acceleration of a stored sample for a vertex with drag `rate`, 1/s.
vec3 accelerationOf(uint sample_, float rate) {
#if RATES
  return accelerationBy(AirForce(got(0u, sample_), got(1u, sample_), got(2u, sample_)), rate);
#else
  return got(0u, sample_);
#endif
}
// Mean acceleration of an edge's samples, weighted by their nearness to the edge's end (`end`) or to its start.
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
    // Only now: momentumScale() of the earlier passes used the old value.
    fastest_before = fastest_now;
    fastest_now = 0u;
  }
  if (me < tile.pieces * tile.strands) {
    uint strand = order[first + me] & 0xFFFFu, piece = order[first + me] >> 16u;
    keep(strand * pieces + tile.margin + piece,
         airForceOn(tile, roots[tile.first_strand + strand], tile.first_piece + piece, first + me));
  }
  if (tile.margin > 0u) {  // the last pieces of the same strands, in the tile before
    uint pieces_before = tiles[workgroupNumber() - 1u].pieces;
    for (uint n = me; n < pieces_before * tile.strands; n += uint(TILE_SAMPLES)) {
      uint from = first - uint(TILE_SAMPLES) + n, strand = order[from] & 0xFFFFu, piece = order[from] >> 16u;
      if (piece + tile.margin >= pieces_before)
        keep(strand * pieces + piece + tile.margin - pieces_before,
             airForceOn(tile, roots[tile.first_strand + strand], tile.first_piece - pieces_before + piece, from));
    }
  }
  barrier();
  bool has_tips = tile.first_piece + tile.pieces == tile.pieces_of_strand;
  uint first_vertex = edgeOf(tile, tile.first_piece);
  uint vertices = edgeOf(tile, tile.first_piece + tile.pieces) + (has_tips ? 1u : 0u) - first_vertex;
  for (uint n = me; n < vertices * tile.strands; n += uint(TILE_SAMPLES)) {
    uvec2 at = divided(n, vertices);  // x: strand, y: vertex
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
