#version 450
// variants: SHAPE_KINDS=0 | SHAPE_KINDS=1 | SHAPE_KINDS=2
// Penetration resolution at the end of a substep: rotates edges whose outer ends exact lengths have put into a body
// until the ends are out of it. The CPU's counterpart is RodStep::resolvePenetration in core/rod_contact.inl.
// Reads: the list of possibly penetrating strands in work[] (mayPenetrate() of rod_contact.glsl), contact cache, bodies.
// Writes: positions and velocities of displaced vertices, the contact cache, guides in the last substep.
// One workgroup per strand, one invocation per vertex. All vertices query contacts at once. Then the first penetrating
// vertex is rotated out, which translates those after it, and these query again.
// SHAPE_KINDS: 0 to 2, see bodies.glsl.
#define WORKGROUP 32
layout(local_size_x = WORKGROUP) in;

#include "kernels/lanes_glsl.h"
#include "kernels/rotation.h"
#include "kernels/contact.h"
#include "kernels/distance_field.h"
#include "gpu_compute/shaders/step_input.glsl"
layout(std430, binding = 0) buffer Positions { vec4 positions[]; };        // xyz, m
layout(std430, binding = 1) buffer Velocities { vec4 velocities[]; };      // xyz, m/s; w: rest distance from bodies, m
layout(std430, binding = 5) readonly buffer Work { uint work[]; };         // see rod_work.glsl
layout(std430, binding = 11) readonly buffer Edges { vec4 edge_rest[]; };  // length, twist; mass, weight of the edge's end
#include "gpu_compute/shaders/bodies.glsl"
#include "gpu_compute/shaders/contact_cache.glsl"
#include "gpu_compute/shaders/contact_query.glsl"
layout(location = 2) uniform uint penetrating_count;
layout(location = 3) uniform uint penetrating_list;
layout(location = 4) uniform int substep;

// The least penetrating position found by rotating the edge from `inner` to x. As RodStep::rotatedOutOfBodies().
vec3 rotatedOutOfBodies(uint vertex, vec3 x, vec3 inner, float edge_length) {
  vec3 best = x;
  float least = -1e9;
  for (int round = 0; round < 5; ++round) {
    ContactPlane plane = deepestPlane(vertex, x);
    if (plane.gap > least) {
      best = x;
      least = plane.gap;
    }
    if (plane.gap >= -contactSlack() || round == 4) break;
    if (round == 3) {
      ContactPlane one = planeOf(vertex, kFirstPlane, best), other = planeOf(vertex, kFirstPlane + kPlaneRows, best);
      if (max(one.gap, other.gap) > 1e8) break;  // the cache has one plane only
      x = rotatedIntoCrease(best, inner, one.carried, one.normal, one.gap, other.carried, other.normal, other.gap, edge_length);
      continue;
    }
    x = round < 2 ? rotatedTowardsPlane(x, inner, plane.normal, plane.gap, edge_length)
                  : rotatedOntoPlane(x, inner, plane.normal, gapToRemove(x, inner, plane.carried, plane.normal, plane.gap),
                                     edge_length);
  }
  return best;
}

const uint kNoVertex = uint(WORKGROUP);
shared vec3 places[WORKGROUP];  // m, current positions of the vertices
shared vec3 shift;              // m, translation of the vertices after the one that was rotated out
shared uint deepest_first;      // the first penetrating vertex, or kNoVertex
shared uint pinned_ones;        // one bit per vertex

void resolvePenetration(uint strand) {
  const uint me = gl_LocalInvocationID.x, end = offsets[strand + 1u];
  vec3 inner = positions[offsets[strand]].xyz, moved_in = vec3(0);
  for (uint first = offsets[strand] + 1u; first < end; first += uint(WORKGROUP)) {
    const bool exists = first + me < end;
    const uint vertex = min(first + me, end - 1u);
    const vec4 edge = edge_rest[vertex - 1u], velocity = velocities[vertex];
    const float velocity_factor = abs(contacts[vertex].w);
    const vec3 reached = positions[vertex].xyz, start = madd(velocity.xyz, -settings.substep / velocity_factor, reached);
    const bool displaced = contacts[vertex].w > 0.0, is_free = exists && edge.w > 0.0;
    if (me == 0u) pinned_ones = 0u;
    barrier();
    if (exists && !is_free) atomicOr(pinned_ones, 1u << me);
    barrier();
    const int pinned_before = findMSB(pinned_ones & ((2u << me) - 1u));  // a pin stops the translation
    vec3 moved = is_free && pinned_before < 0 ? moved_in : vec3(0), x = reached + moved;
    for (uint settled = 0u; settled <= kNoVertex;) {
      bool requeries = is_free && me >= settled && (displaced || dot(moved, moved) > 0.0) && needsRequery(vertex, x);
      ContactSet found;
      if (requeries) found = contactsFrom(strand, vertex, x, start, substep);
      places[me] = x;
      if (me == 0u) deepest_first = kNoVertex;
      barrier();
      if (requeries && found.first.gap < -contactSlack()) atomicMin(deepest_first, me);
      barrier();
      const uint turned = deepest_first;
      if (requeries && me <= turned) storeContacts(vertex, found);
      if (me == turned) {
        places[me] = x = rotatedOutOfBodies(vertex, x, me > 0u ? places[max(me, 1u) - 1u] : inner, edge.x);
        shift = moved = x - reached;
      }
      barrier();
      if (me > turned && is_free && pinned_before < int(turned)) {
        moved = shift;
        x = reached + moved;
      }
      settled = turned + 1u;
    }
    if (exists && dot(moved, moved) > 0.0) {
      positions[vertex].xyz = x;
      velocities[vertex].xyz = madd(moved, settings.per_substep * velocity_factor, velocity.xyz);
      if (substep + 1 == int(settings.substeps)) storeGuide(vertex, x);
    }
    if (me == uint(WORKGROUP) - 1u) shift = moved;
    barrier();
    inner = places[WORKGROUP - 1];
    moved_in = shift;
    barrier();
  }
}

void main() {
  const uint count = work[penetrating_count];
  for (uint at = gl_WorkGroupID.x; at < count; at += gl_NumWorkGroups.x) resolvePenetration(work[penetrating_list + at]);
}
