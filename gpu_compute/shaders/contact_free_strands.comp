#version 450
// Classifies the strands of a group, once a step, after the contact queries of its first substep. A strand is
// contact-free if its separation bound exceeds the travel of all bodies in the whole step; else it is near.
// rod.comp steps contact-free strands without bodies (CONTACT_FREE) and checks afterwards that the bound held.
// Reads: separation bound of the strand (kQueryPoint row of its root), bodies, strand_rest.
// Writes: the lists of contact-free and near strands in work[], and the root's kQueryPoint row.
// One invocation per strand of the group.
#define WORKGROUP 128
#define SHAPE_KINDS 0
layout(local_size_x = WORKGROUP) in;

#include "kernels/lanes_glsl.h"
#include "kernels/rotation.h"
#include "kernels/contact.h"
#include "kernels/distance_field.h"
#include "gpu_compute/shaders/step_input.glsl"
layout(std430, binding = 0) readonly buffer Positions { vec4 positions[]; };  // xyz, m
#include "gpu_compute/shaders/bodies.glsl"
#include "gpu_compute/shaders/contact_cache.glsl"
#include "gpu_compute/shaders/rod_work.glsl"
layout(location = 0) uniform uint group_list;  // index in work[] of the group's first strand
layout(location = 1) uniform uint strands_in_group;
layout(location = 2) uniform uvec2 contact_free_and_near;  // indices in work[] of the two counters
layout(location = 3) uniform uvec2 lists;                  // indices in work[] of the two lists

shared uint counts[2], starts[2];

// Upper bounds, m, of the motion that a body gives a point within `reach` of the root in a substep. x: its whole motion.
// y: the part that carriedBy() leaves out: third-order terms of the rotation, and bending.
vec2 motionBounds(PlacedBody body, vec3 root, float reach) {
  const float turn = length(body.turn), shift = length(body.a_motion);
  const float arm = length(root - body.a) + shift + reach, turn3 = turn * turn * turn;
  return vec2(madd(turn * madd(turn, 0.5, 1.0), arm, shift), madd(turn3 * 0.2, arm, body.bend_shift));
}

// `first`: the first leader body that may touch the strand, or -1. `beyond`: how far any body may move in the step
// relative to the motion of that leader, m.
void boundBodyMotions(uint strand, out float first, out float beyond) {
  const uint root = offsets[strand];
  const vec3 start = positions[root].xyz;
  const float reach = 2.0 * strand_rest[strand].arc_length;
  const uvec2 range = leaderRange(strand);
  first = -1.0;
  beyond = 0.0;
  for (uint i = range.x; i < range.y; ++i) {
    const uint leader = nearBody(i);
    if (bodyAt(leader, 0).leader != leader) continue;
    const bool is_first = first < 0.0;
    if (is_first) first = float(leader);
    float own = kMotionTolerance;
    for (int substep = 0; substep < int(settings.substeps); ++substep) {
      const vec2 way = motionBounds(bodyAt(leader, substep), start, reach);
      own += way.y;
      if (is_first) continue;
      const vec2 way_of_first = motionBounds(bodyAt(uint(first), substep), start, reach);
      own += way.x + way_of_first.x + way_of_first.y;
    }
    beyond = max(beyond, own);
  }
}

// Whether the strand is contact-free in the step; stores the result for rod.comp.
bool sort(uint strand) {
  const uint own = contactRow(offsets[strand], kQueryPoint);
  float first, beyond;
  boundBodyMotions(strand, first, beyond);
  const bool contact_free = contacts[own].x > beyond;
  contacts[own].xy = vec2(contact_free ? beyond : kNear, first);
  return contact_free;
}

void main() {
  const uint me = gl_LocalInvocationID.x;
  const uint number = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * uint(WORKGROUP) + me;
  if (me < 2u) counts[me] = 0u;
  barrier();
  const bool exists = number < strands_in_group;
  uint strand = 0u, which = 0u, at = 0u;
  if (exists) {
    strand = work[group_list + number];
    which = sort(strand) ? 0u : 1u;
    at = atomicAdd(counts[which], 1u);
  }
  barrier();
  if (me < 2u && counts[me] > 0u) starts[me] = atomicAdd(work[contact_free_and_near[me]], counts[me]);
  barrier();
  if (exists) work[lists[which] + starts[which] + at] = strand;
}
