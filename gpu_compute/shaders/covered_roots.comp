#version 450
// variants: TURNING=0 | TURNING=1 | TURNING=2
// Before a step's first look: which roots some body may cover in it, deeper than they are at rest, so that the vertices near them
// cannot get out of it. An invocation per strand. holdOf() of contact_look.glsl goes by it; TURNING: see bodies.glsl.
#define WORKGROUP 64
layout(local_size_x = WORKGROUP) in;

#include "kernels/lanes_glsl.h"
#include "kernels/rotation.h"
#include "kernels/contact.h"
#include "kernels/distance_field.h"
#include "gpu_compute/shaders/step_input.glsl"
#include "gpu_compute/shaders/strand_offsets.glsl"
#include "gpu_compute/shaders/bodies.glsl"
#include "gpu_compute/shaders/contact_sights.glsl"
#include "gpu_compute/shaders/root_poses.glsl"
layout(std430, binding = 1) readonly buffer Velocities { vec4 velocities[]; };  // w: rest distance from bodies, m
layout(std430, binding = 11) readonly buffer Edges { vec4 edge_rest[]; };       // length, ...

// At most how deeply a body covers a root in the step, m, beyond what the root's clearance asks; `begin`, `end`: where the root is in the
// first substep.
float mostDepth(PlacedBody body, vec3 begin, vec3 end, float clear) {
  // From substep to substep it goes as far once more, but for what is not even in the motion.
  float way = length(end - carriedBy(begin, body.a, body.a_motion, body.turn)) + body.bend_shift;
  float ways = 1.1 * way * float(settings.substeps);
  if (length(end - body.middle) - body.ball > clear + ways) return 0.0;
  vec3 normal;
  return clear - surfaceAt(body, end, pushedByNothing(), normal) + ways;
}

void main() {
  const uint strand = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * uint(WORKGROUP) + gl_LocalInvocationID.x;
  if (strand >= settings.strand_count) return;
  const uint root = offsets[strand];
  const RootPoses poses = rootPoses(strand);
  const vec3 begin = poses.begin.position, end = madd(poses.end.position - begin, timeAfter(0), begin);
  const float clear = clearance(velocities[root]);
  const uvec2 range = nearRange(strand);
  float depth = 0.0;
  for (uint i = range.x; i < range.y; ++i) depth = max(depth, mostDepth(bodyAt(nearBody(i), 0), begin, end, clear));
  const float way_out = wayOutOf(depth);
  contacts[sightAt(root, kLooked)].w = way_out > edge_rest[root].x ? way_out : 0.0;
}
