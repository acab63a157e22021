#version 450
// Once a step, after its first look: lists a group's strands as clear, where it seems that no body will come near one in the whole step,
// or as near. Clear ones are done without bodies: rod.comp.
#define WORKGROUP 128
#define TURNING 0
layout(local_size_x = WORKGROUP) in;

#include "kernels/lanes_glsl.h"
#include "kernels/rotation.h"
#include "kernels/contact.h"
#include "kernels/distance_field.h"
#include "gpu_compute/shaders/step_input.glsl"
#include "gpu_compute/shaders/strand_offsets.glsl"
layout(std430, binding = 0) readonly buffer Positions { vec4 positions[]; };  // xyz, m
#include "gpu_compute/shaders/bodies.glsl"
#include "gpu_compute/shaders/contact_sights.glsl"
#include "gpu_compute/shaders/rod_work.glsl"
layout(location = 0) uniform uint group_list;  // places in work[]
layout(location = 1) uniform uint strands_in_group;
layout(location = 2) uniform uvec2 clear_and_near;  // how many
layout(location = 3) uniform uvec2 lists;

shared uint counts[2], starts[2];

// How far a body may take a point near the strand in a substep, at most, m: x; y: beyond where carriedBy() takes it.
vec2 wayOf(PlacedBody body, vec3 root, float reach) {
  const float turn = length(body.turn), shift = length(body.a_motion);
  const float arm = length(root - body.a) + shift + reach, turn3 = turn * turn * turn;
  return vec2(madd(turn * madd(turn, 0.5, 1.0), arm, shift), madd(turn3 * 0.2, arm, body.bend_shift));
}

// The first body that may touch the strand, or -1; how far all may come in the step beyond where that one takes them, m.
void waysOfBodies(uint strand, out float first, out float beyond) {
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
    float own = kAlike;
    for (int substep = 0; substep < int(settings.substeps); ++substep) {
      const vec2 way = wayOf(bodyAt(leader, substep), start, reach);
      own += way.y;
      if (is_first) continue;
      const vec2 way_of_first = wayOf(bodyAt(uint(first), substep), start, reach);
      own += way.x + way_of_first.x + way_of_first.y;
    }
    beyond = max(beyond, own);
  }
}

bool sort(uint strand) {
  const uint own = sightAt(offsets[strand], kLooked);
  float first, beyond;
  waysOfBodies(strand, first, beyond);
  const bool clear = contacts[own].x > beyond;
  contacts[own].xy = vec2(clear ? beyond : kNear, first);
  return clear;
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
  if (me < 2u && counts[me] > 0u) starts[me] = atomicAdd(work[clear_and_near[me]], counts[me]);
  barrier();
  if (exists) work[lists[which] + starts[which] + at] = strand;
}
