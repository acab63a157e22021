#version 450
// Lists the vertices that have to look at bodies in a substep: all but those that cannot have come near one since they last
// saw none. 32 invocations do a strand.
#define WORKGROUP 512
layout(local_size_x = WORKGROUP) in;

#define TURNING 0
#include "kernels/lanes_glsl.h"
#include "kernels/rotation.h"
#include "kernels/contact.h"
#include "kernels/distance_field.h"
#include "gpu_compute/shaders/step_input.glsl"
#include "gpu_compute/shaders/strand_offsets.glsl"
#include "gpu_compute/shaders/bodies.glsl"
#include "gpu_compute/shaders/contact_sights.glsl"
#include "gpu_compute/shaders/root_poses.glsl"
#include "gpu_compute/shaders/look_ahead.glsl"
layout(location = 2) uniform bool everyone;  // what vertices have seen is of other bodies

shared uint many, first;

// At most how far it is from start to x, seen from any of the bodies that the strand may touch.
float wayAlong(uint strand, vec3 x, vec3 start) {
  uvec2 range = nearRange(strand);
  uint leader = ~0u;
  float most = 0.0;
  for (uint i = range.x; i < range.y; ++i) {
    PlacedBody body = bodyAt(nearBody(i), substep);
    if (body.leader == leader) continue;
    leader = body.leader;
    body = bodyAt(leader, substep);
    float turn = length(body.turn);  // of the third order in it is what carriedBy() leaves out
    float slack = madd(turn * turn * turn * 0.2, length(start - body.a), kAlike) + body.bend_shift;
    most = max(most, length(x - carriedBy(start, body.a, body.a_motion, body.turn)) + slack);
  }
  return most;
}

bool isDue(uint strand, uint vertex, vec3 jump) {
  uint sight = sightAt(vertex, kLooked);
  vec4 looked = contacts[sight];
  if (everyone || seesPlanes(looked)) return true;
  vec3 start = positions[vertex].xyz, ahead = aheadOf(vertex, jump);
  // Its reach grows by half of its way.
  float room = looked.w - length(start - looked.xyz) - 1.5 * wayAlong(strand, ahead, start);
  if (!(room >= 0.0)) return true;
  contacts[sight] = vec4(ahead, room);
  return false;
}

void main() {
  uint strand = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * uint(WORKGROUP / 32) + gl_LocalInvocationID.x / 32u;
  if (gl_LocalInvocationID.x == 0u) many = 0u;
  barrier();
  uint due = 0u, root = 0u, number = 1u + gl_LocalInvocationID.x % 32u;  // due: a bit for every 32nd vertex
  if (strand < settings.strand_count) {
    root = offsets[strand];
    vec3 jump = jumpOf(strand);
    uint vertices = offsets[strand + 1u] - root;
    for (uint k = 0u; number + 32u * k < vertices; ++k)
      if (isDue(strand, root + number + 32u * k, jump)) due |= 1u << k;
  }
  uint at = atomicAdd(many, uint(bitCount(due)));
  barrier();
  if (gl_LocalInvocationID.x == 0u) first = atomicAdd(work[looks_count], many);
  barrier();
  at += first;
  for (uint k = 0u; k < 4u; ++k)
    if ((due >> k & 1u) != 0u) work[looks_list + at++] = listed(strand, number + 32u * k);
}
