#version 450
// variants: TURNING=0 SORTING=0 | TURNING=1 SORTING=1 | TURNING=2 SORTING=2
// The vertices that have to look at bodies at the start of a substep do so: all but those that cannot have come near one since they
// last saw none. A workgroup finds those of STRANDS strands, 32 invocations going over one, and then they look together, for few
// of a strand do. TURNING: see bodies.glsl. SORTING: 1: after this first look of a step clear_strands.comp sorts them;
// 2: later, of near ones; 0: they are not sorted.
#define WORKGROUP 64
#define STRANDS 8  // kStrandsLooking of gpu_compute/rod_strands.cc
#define MOST_VERTICES 128  // of a strand
layout(local_size_x = WORKGROUP) in;

#include "kernels/lanes_glsl.h"
#include "kernels/rotation.h"
#include "kernels/contact.h"
#include "kernels/distance_field.h"
#include "gpu_compute/shaders/step_input.glsl"
#include "gpu_compute/shaders/strand_offsets.glsl"
layout(std430, binding = 0) readonly buffer Positions { vec4 positions[]; };    // xyz, m
layout(std430, binding = 1) readonly buffer Velocities { vec4 velocities[]; };  // xyz, m/s; w: rest distance from bodies, m
layout(std430, binding = 11) readonly buffer Edges { vec4 edge_rest[]; };       // length, twist; mass, weight of its end
#include "gpu_compute/shaders/bodies.glsl"
#include "gpu_compute/shaders/contact_sights.glsl"
#include "gpu_compute/shaders/root_cover.glsl"
#include "gpu_compute/shaders/contact_look.glsl"
layout(location = 0) uniform int substep;
layout(location = 1) uniform bool everyone;  // what vertices have seen is of other bodies

shared vec3 jumps[STRANDS];
shared uint due_count, due[STRANDS * MOST_VERTICES];  // strand of the workgroup x MOST_VERTICES + number in it
#if SORTING == 1
shared uint short_count;     // of vertices whose room will not last for the step, from the end of due[] on
// Of strands, bits of floats, m: the least roomAfterStep() of vertices that are due; of the others.
shared uint rooms_due[STRANDS], rooms[STRANDS];
#elif SORTING == 2
shared bool are_clear[STRANDS];
#endif

// Unexpected motion of the strand's root in the substep, m: its vertices go along with it. After the first substep of a step there
// is none: the root goes on as it went.
vec3 jumpOf(uint strand) {
  if (substep > 0) return vec3(0);
  const uint root = offsets[strand];
  return vec3(contacts[sightAt(root, kRootPosition)].w, contacts[sightAt(root, kRootTangent)].w, contacts[sightAt(root, kCover)].w);
}
// Where it would go by itself.
vec3 aheadOf(uint vertex, vec3 jump) {
  return madd(velocities[vertex].xyz, settings.substep * settings.keep, positions[vertex].xyz) + jump;
}

// At most how far it is from start to x, seen from any of the bodies that the strand may touch.
float wayAlong(uint strand, vec3 x, vec3 start) {
  uvec2 range = leaderRange(strand);
  float most = 0.0;
  for (uint i = range.x; i < range.y; ++i) {
    uint leader = nearBody(i);
    PlacedBody body = bodyAt(leader, substep);
    if (body.leader != leader) continue;
    float turn = length(body.turn);  // of the third order in it is what carriedBy() leaves out
    float slack = madd(turn * turn * turn * 0.2, length(start - body.a), kAlike) + body.bend_shift;
    most = max(most, length(x - carriedBy(start, body.a, body.a_motion, body.turn)) + slack);
  }
  return most;
}

#if SORTING == 1
// What a vertex will have left, if all its ways in the step are like its first or a little longer, of the `room` at the end of that one, m:
// see comesNear() in rod_clear.glsl.
float roomAfterStep(float room, float way) { return room - madd(1.2, float(settings.substeps) + 0.5, 1.0) * way; }
// After it has looked; as bits of a float.
uint roomSeen(uint strand, uint vertex, vec3 ahead, vec3 start) {
  const bool pressed = contacts[vertex].xyz != vec3(0);
  const float room = roomOf(vertex, contacts[sightAt(vertex, kLooked)]);
  return floatBitsToUint(pressed ? 0.0 : max(roomAfterStep(room, wayAlong(strand, ahead, start)), 0.0));
}
#endif

bool isDue(uint strand, uint own, uint vertex, vec3 jump) {
  uint sight = sightAt(vertex, kLooked);
  vec4 looked = contacts[sight];
  if (everyone || seesPlanes(looked)) return true;
  vec3 start = positions[vertex].xyz, ahead = aheadOf(vertex, jump);
  // Its reach grows by half of its way.
  float way = wayAlong(strand, ahead, start);
  float room = looked.w - length(start - looked.xyz) - 1.5 * way;
  if (!(room >= 0.0)) return true;
  contacts[sight] = vec4(ahead, room);
#if SORTING == 1
  const float left = roomAfterStep(room, way);
  if (left > 0.0 && contacts[vertex].xyz == vec3(0)) atomicMin(rooms[own], floatBitsToUint(left));
  else due[uint(STRANDS * MOST_VERTICES) - 1u - atomicAdd(short_count, 1u)] = own * uint(MOST_VERTICES) + vertex - offsets[strand];
#endif
  return false;
}

void main() {
  const uint me = gl_LocalInvocationID.x;
  const uint first = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * uint(STRANDS);
  if (me == 0u) due_count = 0u;
#if SORTING == 2
  if (me < uint(STRANDS) && first + me < settings.strand_count) are_clear[me] = isClear(first + me);
#endif
#if SORTING == 1
  if (me == 0u) short_count = 0u;
  if (me < uint(STRANDS)) rooms_due[me] = rooms[me] = floatBitsToUint(1e9);
#endif
  barrier();
  for (uint own = me / 32u; own < uint(STRANDS) && first + own < settings.strand_count; own += uint(WORKGROUP) / 32u) {
    const uint strand = first + own, root = offsets[strand], end = offsets[strand + 1u];
#if SORTING == 2
    if (are_clear[own]) continue;
#endif
    const vec3 jump = jumpOf(strand);
    if (me % 32u == 0u) jumps[own] = jump;
    for (uint number = 1u + me % 32u; root + number < end; number += 32u)
      if (isDue(strand, own, root + number, jump)) due[atomicAdd(due_count, 1u)] = own * uint(MOST_VERTICES) + number;
  }
  barrier();
  for (uint at = me; at < due_count; at += uint(WORKGROUP)) {
    const uint own = due[at] / uint(MOST_VERTICES), vertex = offsets[first + own] + due[at] % uint(MOST_VERTICES);
    const vec3 start = positions[vertex].xyz, ahead = aheadOf(vertex, jumps[own]);
    look(first + own, vertex, ahead, start, substep);
#if SORTING == 1
    atomicMin(rooms_due[own], roomSeen(first + own, vertex, ahead, start));
#endif
  }
#if SORTING == 1
  barrier();
  for (uint at = me; at < short_count; at += uint(WORKGROUP)) {
    const uint which = due[uint(STRANDS * MOST_VERTICES) - 1u - at], own = which / uint(MOST_VERTICES);
    if (rooms_due[own] == 0u) continue;  // it would not help the strand
    const uint vertex = offsets[first + own] + which % uint(MOST_VERTICES);
    const vec3 start = positions[vertex].xyz, ahead = aheadOf(vertex, jumps[own]);
    look(first + own, vertex, ahead, start, substep);
    atomicMin(rooms[own], roomSeen(first + own, vertex, ahead, start));
  }
  barrier();
  if (me < uint(STRANDS) && first + me < settings.strand_count) {
    const uint sight = sightAt(offsets[first + me], kLooked);
    const bool covered = contacts[sight].w > 0.0;
    contacts[sight].x = covered ? 0.0 : uintBitsToFloat(min(rooms_due[me], rooms[me]));
  }
#endif
}
