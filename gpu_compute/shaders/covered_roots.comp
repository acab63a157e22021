#version 450
// variants: TURNING=0 | TURNING=1 | TURNING=2
// Before a step's first look: which bodies cover the roots in it. An invocation per strand. holdOf() of contact_look.glsl goes by it;
// TURNING: see bodies.glsl.
#define WORKGROUP 64
layout(local_size_x = WORKGROUP) in;

#include "kernels/lanes_glsl.h"
#include "kernels/rotation.h"
#include "kernels/contact.h"
#include "kernels/distance_field.h"
#include "gpu_compute/shaders/step_input.glsl"
#include "gpu_compute/shaders/strand_offsets.glsl"
#include "gpu_compute/shaders/bodies.glsl"
#include "gpu_compute/shaders/root_cover.glsl"
#include "gpu_compute/shaders/contact_sights.glsl"
#include "gpu_compute/shaders/root_poses.glsl"
layout(std430, binding = 1) readonly buffer Velocities { vec4 velocities[]; };  // w: rest distance from bodies, m
layout(std430, binding = 11) readonly buffer Edges { vec4 edge_rest[]; };       // length, ...

void main() {
  const uint strand = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * uint(WORKGROUP) + gl_LocalInvocationID.x;
  if (strand >= settings.strand_count) return;
  const uint root = offsets[strand];
  const RootPoses poses = rootPoses(strand);
  const vec3 begin = poses.begin.position, end = poses.end.position;
  const RootCover cover =
      coverOf(strand, begin, madd(end - begin, timeAfter(0), begin), end, clearance(velocities[root]), edge_rest[root].x);
  contacts[sightAt(root, kCover)] = vec4(float(cover.bodies), cover.first, cover.last, 0);
}
