#version 450
// variants: FORCES=1 AIR=2 RATES=0 ALONG=0 | FORCES=0 AIR=1 RATES=1 ALONG=1 | FORCES=1 AIR=0 RATES=0 ALONG=0 | FORCES=1 AIR=2 RATES=1 ALONG=1
// From the grids to an acceleration per vertex: an invocation a sample, which also gives it to the vertices that begin there;
// a vertex between two samples has a part of both, so workgroups overlap. FORCES: between hairs. AIR: 0 uniform, 1 as it
// blows with nothing in the way, 2 on the grid. RATES: vertices have drags of their own. ALONG: drag along strands is less.
#define WORKGROUP 128
#define MOST_PARTS 16
layout(local_size_x = WORKGROUP) in;
#include "kernels/lanes_glsl.h"
#include "kernels/grid.h"
#include "gpu_compute/shaders/air_settings.glsl"
#include "gpu_compute/shaders/hair_pieces.glsl"
#include "gpu_compute/shaders/hair_samples.glsl"
#include "gpu_compute/shaders/ambient.glsl"
layout(std430, binding = 7) readonly buffer Rates { float rates[]; };       // 1/s per vertex
layout(std430, binding = 8) writeonly buffer Guides { float guides[]; };    // 3 per vertex, m/s^2
layout(std430, binding = 11) readonly buffer Changes { vec4 changes[]; };   // m/s
layout(std430, binding = 12) readonly buffer Centres { vec4 centres[]; };   // m/s, of the wind's cells
layout(location = 0) uniform int margin;  // samples before and behind a workgroup's own that it also looks at

struct Felt {
  vec3 pushed;    // m/s^2
  vec3 local;     // m/s, of the air beyond the uniform wind
  vec3 not_felt;  // m/s: x rate, see dragNotFelt
};
shared vec3 pushes[WORKGROUP];
#if AIR != 0
shared vec3 locals[WORKGROUP];
#endif
#if ALONG
shared vec3 not_felts[WORKGROUP];
#endif

#define CORNERS(of)                                                                                          \
  vec4[8](of[first], of[first + 1], of[first + y], of[first + y + 1], of[first + z], of[first + z + 1], \
          of[first + z + y], of[first + z + y + 1])

bool isFinite(vec3 v) { return !any(isnan(v)) && !any(isinf(v)); }

Felt feltBy(uint n) {
  Felt felt = Felt(vec3(0), vec3(0), vec3(0));
  vec3 at = placeOf(n), wind = air.uniform_wind.xyz;
  vec3 place, motion;
  float mass;
  int y = air.cells, z = y * y;
#if ALONG || AIR == 1
  middleOf(pieceOf(n), place, motion, mass);
#endif
#if FORCES
  {
    GridPlace corner = placeAmong(at);
    int first = nodeAt(ivec3(corner.low));
    vec4 change = interpolated4(CORNERS(changes), corner.part);
    if (change.w != 0.0) {
#if !(ALONG || AIR == 1)
      middleOf(pieceOf(n), place, motion, mass);
#endif
      change.xyz -= change.w * motion;
    }
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
  wind = ambientAt(place);
  for (int i = 0; i < air.sources; ++i) {
    vec3 blown;
    if (isBlown(sources[i], place, blown)) wind += blown;
  }
#endif
  felt.local = wind - air.uniform_wind.xyz;
#if ALONG
  Piece piece = pieceOf(n);
  vec3 chord = positions[piece.last].xyz - positions[piece.first].xyz;
  float far = length(chord);
  vec3 tangent = far > 0.0 ? chord / far : vec3(0);
  felt.not_felt = dragNotFelt(wind - motion, tangent, 1.0, air.uniform_wind.w);
#endif
  // Of a strand that went wrong, or left the grid.
  if (!isFinite(felt.pushed + felt.local + felt.not_felt)) felt = Felt(vec3(0), vec3(0), vec3(0));
  return felt;
}

vec3 accelerationBy(uint slot, uint vertex) {
#if RATES
  float rate = rates[vertex];
#else
  float rate = air.drag;
#endif
  vec3 sum = pushes[slot];
#if AIR != 0
  sum = madd(locals[slot], rate, sum);
#endif
#if ALONG
  sum -= not_felts[slot] * min(rate, inverse(air.seconds));
#endif
  return sum;
}
void give(uint vertex, vec3 acceleration) {
  guides[3u * vertex] = acceleration.x;
  guides[3u * vertex + 1u] = acceleration.y;
  guides[3u * vertex + 2u] = acceleration.z;
}

void main() {
  uint me = gl_LocalInvocationID.x;
  int own = WORKGROUP - 2 * margin, n = int(workgroupNumber()) * own + int(me) - margin;
  bool exists = n >= 0 && n < int(air.samples);
  Felt felt = Felt(vec3(0), vec3(0), vec3(0));
  if (exists) felt = feltBy(uint(n));
  pushes[me] = felt.pushed;
#if AIR != 0
  locals[me] = felt.local;
#endif
#if ALONG
  not_felts[me] = felt.not_felt;
#endif
  if (gl_WorkGroupID.x + gl_WorkGroupID.y + me == 0u) {  // for the next step
    fastest_before = fastest_now;
    fastest_now = 0u;
  }
  barrier();
  if (!exists || int(me) < margin || int(me) >= WORKGROUP - margin) return;
  Piece piece = pieceOf(uint(n));
  if (piece.part != 0u) return;
  // Vertices from the first on, of the last piece to the tip: parts of the edges before and behind.
  bool is_last = piece.last == piece.tip;
  for (uint v = piece.first; v < piece.last || (v == piece.tip && is_last); ++v) {
    float before = v > piece.root ? edge_masses[v - 1u] : 0.0, behind = v < piece.tip ? edge_masses[v] : 0.0;
    float per_mass = inverse(max(before + behind, 1e-30));
    vec3 sum = vec3(0);
    for (uint part = 0u; part < piece.parts; ++part) {
      float along_edge = (float(part) + 0.5) / float(piece.parts), share = 2.0 * per_mass / float(piece.parts);
      // The piece of the edge before: this one, or the one before this one. At the tip this one's edge is the one before.
      uint slot_before = v > piece.first ? me + part : me - piece.parts + part, slot_behind = me + part;
      if (before > 0.0) sum += accelerationBy(slot_before, v) * (before * share * along_edge);
      if (behind > 0.0) sum += accelerationBy(slot_behind, v) * (behind * share * (1.0 - along_edge));
    }
    give(v, sum);
  }
}
