#version 450
// variants: SHAPE_KINDS=0 SORTING=0 | SHAPE_KINDS=1 SORTING=1 | SHAPE_KINDS=2 SORTING=2
// Contact queries at the start of a substep. A vertex skips its query while its separation bound shows that it cannot
// have come near a body since the last query found none.
// Reads: positions, velocities, bodies, the contact cache, root motion from roots.comp.
// Writes: the contact cache; with SORTING 1 the strand's separation bound after the step, to the root's kQueryPoint.x.
// One workgroup per STRANDS strands. 32 invocations scan the vertices of a strand for due queries; then all invocations
// share the due queries of the workgroup, because few vertices of a strand are due.
// SHAPE_KINDS: 0 to 2, see bodies.glsl.
// SORTING: 0: strands are not classified.
//          1: first substep of a step whose strands contact_free_strands.comp classifies next.
//          2: later substeps of such a step: contact-free strands are skipped.
#define WORKGROUP 64
#define STRANDS 8         // kStrandsPerQuery of gpu_compute/rod_strands.cc
#define MAX_VERTICES 128  // of a strand
layout(local_size_x = WORKGROUP) in;

#include "kernels/lanes_glsl.h"
#include "kernels/rotation.h"
#include "kernels/contact.h"
#include "kernels/distance_field.h"
#include "gpu_compute/shaders/step_input.glsl"
layout(std430, binding = 0) readonly buffer Positions { vec4 positions[]; };    // xyz, m
layout(std430, binding = 1) readonly buffer Velocities { vec4 velocities[]; };  // xyz, m/s; w: rest distance from bodies, m
layout(std430, binding = 11) readonly buffer Edges { vec4 edge_rest[]; };       // length, twist; mass, weight of the edge's end
#include "gpu_compute/shaders/bodies.glsl"
#include "gpu_compute/shaders/contact_cache.glsl"
#include "gpu_compute/shaders/contact_query.glsl"
layout(location = 0) uniform int substep;
layout(location = 1) uniform bool query_all;  // every vertex queries: the cache is of other bodies

shared vec3 jumps[STRANDS];
shared uint due_count, due[STRANDS * MAX_VERTICES];  // strand of the workgroup x MAX_VERTICES + number in it
#if SORTING == 1
shared uint short_count;  // vertices whose bound does not last for the step; stored from the end of due[] down
// Per strand, m, as bits of a float: the least boundAfterStep() of the vertices that are due, and of the others.
shared uint bounds_due[STRANDS], bounds[STRANDS];
#elif SORTING == 2
shared bool are_contact_free[STRANDS];
#endif

// Jump of the strand's root in the substep, m: the difference to going on at its last velocity. Vertices move by it too.
// 0 after the first substep of a step, because the root moves evenly within a step.
vec3 jumpOf(uint strand) {
  if (substep > 0) return vec3(0);
  const uint root = offsets[strand];
  return vec3(contacts[contactRow(root, kRootPosition)].w, contacts[contactRow(root, kRootTangent)].w,
              contacts[contactRow(root, kCover)].w);
}
// Predicted position of a vertex at the end of the substep: its inertial point.
vec3 predictedPosition(uint vertex, vec3 jump) {
  return madd(velocities[vertex].xyz, settings.substep * settings.keep, positions[vertex].xyz) + jump;
}

// Upper bound, m, of the travel from `start` to x as seen from any body that the strand may touch.
float relativeTravel(uint strand, vec3 x, vec3 start) {
  uvec2 range = leaderRange(strand);
  float most = 0.0;
  for (uint i = range.x; i < range.y; ++i) {
    uint leader = nearBody(i);
    PlacedBody body = bodyAt(leader, substep);
    if (body.leader != leader) continue;
    float turn = length(body.turn);  // carriedBy() leaves out terms of third order in it
    float slack = madd(turn * turn * turn * 0.2, length(start - body.a), kMotionTolerance) + body.bend_shift;
    most = max(most, length(x - carriedBy(start, body.a, body.a_motion, body.turn)) + slack);
  }
  return most;
}

#if SORTING == 1
// Predicted separation bound at the end of the step, m, of a vertex with bound `room` after the first substep, in which
// its relative travel was `way`. Assumes up to 1.2 times that travel per substep. mayTouchBody() in rod_contact_free.glsl
// checks the result.
float boundAfterStep(float room, float way) { return room - madd(1.2, float(settings.substeps) + 0.5, 1.0) * way; }
// The same after the vertex's query, at least 0, as bits of a float; 0 for a vertex that a body presses.
uint boundAfterQuery(uint strand, uint vertex, vec3 ahead, vec3 start) {
  const bool pressed = contacts[vertex].xyz != vec3(0);
  const float room = separationBound(vertex, contacts[contactRow(vertex, kQueryPoint)]);
  return floatBitsToUint(pressed ? 0.0 : max(boundAfterStep(room, relativeTravel(strand, ahead, start)), 0.0));
}
#endif

// Whether the vertex needs a query; if not, moves its query point along and lowers its separation bound.
bool isDue(uint strand, uint own, uint vertex, vec3 jump) {
  uint found = contactRow(vertex, kQueryPoint);
  vec4 queried = contacts[found];
  if (query_all || hasPlanes(queried)) return true;
  vec3 start = positions[vertex].xyz, ahead = predictedPosition(vertex, jump);
  // The query's reach grows by half of the travel, so the bound falls by 1.5 times it.
  float way = relativeTravel(strand, ahead, start);
  float room = queried.w - length(start - queried.xyz) - 1.5 * way;
  if (!(room >= 0.0)) return true;
  contacts[found] = vec4(ahead, room);
#if SORTING == 1
  const float left = boundAfterStep(room, way);
  if (left > 0.0 && contacts[vertex].xyz == vec3(0))
    atomicMin(bounds[own], floatBitsToUint(left));
  else
    due[uint(STRANDS * MAX_VERTICES) - 1u - atomicAdd(short_count, 1u)] = own * uint(MAX_VERTICES) + vertex - offsets[strand];
#endif
  return false;
}

void main() {
  const uint me = gl_LocalInvocationID.x;
  const uint first = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * uint(STRANDS);
  if (me == 0u) due_count = 0u;
#if SORTING == 2
  if (me < uint(STRANDS) && first + me < settings.strand_count) are_contact_free[me] = isContactFree(first + me);
#endif
#if SORTING == 1
  if (me == 0u) short_count = 0u;
  if (me < uint(STRANDS)) bounds_due[me] = bounds[me] = floatBitsToUint(1e9);
#endif
  barrier();
  for (uint own = me / 32u; own < uint(STRANDS) && first + own < settings.strand_count; own += uint(WORKGROUP) / 32u) {
    const uint strand = first + own, root = offsets[strand], end = offsets[strand + 1u];
#if SORTING == 2
    if (are_contact_free[own]) continue;
#endif
    const vec3 jump = jumpOf(strand);
    if (me % 32u == 0u) jumps[own] = jump;
    for (uint number = 1u + me % 32u; root + number < end; number += 32u)
      if (isDue(strand, own, root + number, jump)) due[atomicAdd(due_count, 1u)] = own * uint(MAX_VERTICES) + number;
  }
  barrier();
  for (uint at = me; at < due_count; at += uint(WORKGROUP)) {
    const uint own = due[at] / uint(MAX_VERTICES), vertex = offsets[first + own] + due[at] % uint(MAX_VERTICES);
    const vec3 start = positions[vertex].xyz, ahead = predictedPosition(vertex, jumps[own]);
    queryContacts(first + own, vertex, ahead, start, substep);
#if SORTING == 1
    atomicMin(bounds_due[own], boundAfterQuery(first + own, vertex, ahead, start));
#endif
  }
#if SORTING == 1
  barrier();
  for (uint at = me; at < short_count; at += uint(WORKGROUP)) {
    const uint which = due[uint(STRANDS * MAX_VERTICES) - 1u - at], own = which / uint(MAX_VERTICES);
    if (bounds_due[own] == 0u) continue;  // the strand is near in any case
    const uint vertex = offsets[first + own] + which % uint(MAX_VERTICES);
    const vec3 start = positions[vertex].xyz, ahead = predictedPosition(vertex, jumps[own]);
    queryContacts(first + own, vertex, ahead, start, substep);
    atomicMin(bounds[own], boundAfterQuery(first + own, vertex, ahead, start));
  }
  barrier();
  if (me < uint(STRANDS) && first + me < settings.strand_count) {
    const uint found = contactRow(offsets[first + me], kQueryPoint);
    const bool covered = contacts[found].w > 0.0;
    contacts[found].x = covered ? 0.0 : uintBitsToFloat(min(bounds_due[me], bounds[me]));
  }
#endif
}
