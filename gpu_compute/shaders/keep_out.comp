#version 450
// variants: TURNING=0 | TURNING=1 | TURNING=2
// Strands that exact lengths have placed in a body in this substep, or that have come too far from where they looked at
// bodies: every vertex, from the root on, is held to the side of the bodies it was on. RodStep::keptOut in
// core/kept_out.inl. A workgroup does a strand, an invocation a vertex: all look at once, then the first that is in a body is
// turned out, which moves those after it, and these look once more. TURNING: see bodies.glsl.
#define WORKGROUP 32
layout(local_size_x = WORKGROUP) in;

#include "kernels/lanes_glsl.h"
#include "kernels/rotation.h"
#include "kernels/contact.h"
#include "kernels/distance_field.h"
#include "gpu_compute/shaders/step_input.glsl"
#include "gpu_compute/shaders/strand_offsets.glsl"
layout(std430, binding = 0) buffer Positions { vec4 positions[]; };            // xyz, m
layout(std430, binding = 1) buffer Velocities { vec4 velocities[]; };          // xyz, m/s; w: rest distance from bodies, m
layout(std430, binding = 5) readonly buffer Work { uint work[]; };             // see rod_strand.glsl
layout(std430, binding = 11) readonly buffer Edges { vec4 edge_rest[]; };      // length, twist; mass, weight of its end
#include "gpu_compute/shaders/bodies.glsl"
#include "gpu_compute/shaders/contact_sights.glsl"
#include "gpu_compute/shaders/root_cover.glsl"
#include "gpu_compute/shaders/contact_look.glsl"
layout(location = 2) uniform uint lost_count;
layout(location = 3) uniform uint lost_list;
layout(location = 4) uniform int substep;

// `inner`: where its edge starts. Where it is least deep, as RodStep::turnedOutOfBodies().
vec3 turnedOutOfBodies(uint vertex, vec3 x, vec3 inner, float edge_length) {
  vec3 best = x;
  float least = -1e9;
  for (int round = 0; round < 5; ++round) {
    Touch touch = touchOf(vertex, x);
    if (touch.gap > least) {
      best = x;
      least = touch.gap;
    }
    if (touch.gap >= -contactSlack() || round == 4) break;
    if (round == 3) {
      Touch one = planeOf(vertex, kFirstPlane, best), other = planeOf(vertex, kFirstPlane + kPlaneRows, best);
      if (max(one.gap, other.gap) > 1e8) break;  // there is one plane only
      x = turnedIntoCrease(best, inner, one.carried, one.normal, one.gap, other.carried, other.normal, other.gap, edge_length);
      continue;
    }
    x = round < 2
            ? turnedTowards(x, inner, touch.normal, touch.gap, edge_length)
            : turnedOut(x, inner, touch.normal, lastTurn(x, inner, touch.carried, touch.normal, touch.gap), edge_length);
  }
  return best;
}

const uint kNobody = uint(WORKGROUP);
shared vec3 places[WORKGROUP];  // m, of the vertices
shared vec3 shift;              // m, of the vertices after the one that was turned out
shared uint deepest_first;      // the first that is in a body
shared uint pinned_ones;        // a bit each

void keepOut(uint strand) {
  const uint me = gl_LocalInvocationID.x, end = offsets[strand + 1u];
  vec3 inner = positions[offsets[strand]].xyz, moved_in = vec3(0);
  for (uint first = offsets[strand] + 1u; first < end; first += uint(WORKGROUP)) {
    const bool exists = first + me < end;
    const uint vertex = min(first + me, end - 1u);
    const vec4 edge = edge_rest[vertex - 1u], velocity = velocities[vertex];
    const float speed_kept = abs(contacts[vertex].w);
    const vec3 reached = positions[vertex].xyz, start = madd(velocity.xyz, -settings.substep / speed_kept, reached);
    const bool displaced = contacts[vertex].w > 0.0, is_free = exists && edge.w > 0.0;
    if (me == 0u) pinned_ones = 0u;
    barrier();
    if (exists && !is_free) atomicOr(pinned_ones, 1u << me);
    barrier();
    const int pinned_before = findMSB(pinned_ones & ((2u << me) - 1u));  // nothing before it moves this vertex
    vec3 moved = is_free && pinned_before < 0 ? moved_in : vec3(0), x = reached + moved;
    for (uint settled = 0u; settled <= kNobody;) {
      bool looks = is_free && me >= settled && (displaced || dot(moved, moved) > 0.0) && looksBack(vertex, x);
      Sight sight;
      if (looks) sight = sightFrom(strand, vertex, x, start, substep);
      places[me] = x;
      if (me == 0u) deepest_first = kNobody;
      barrier();
      if (looks && sight.first.gap < -contactSlack()) atomicMin(deepest_first, me);
      barrier();
      const uint turned = deepest_first;
      if (looks && me <= turned) keepSight(vertex, sight);
      if (me == turned) {
        places[me] = x = turnedOutOfBodies(vertex, x, me > 0u ? places[max(me, 1u) - 1u] : inner, edge.x);
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
      velocities[vertex].xyz = madd(moved, settings.per_substep * speed_kept, velocity.xyz);
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
  const uint count = work[lost_count];
  for (uint at = gl_WorkGroupID.x; at < count; at += gl_NumWorkGroups.x) keepOut(work[lost_list + at]);
}
