#version 450
// variants: TURNING=0 | TURNING=1 | TURNING=2
// Before a substep's first look: how the roots move, for all dispatches after it, and which bodies cover them. An invocation per strand;
// those that no body may cover in the whole step are asked in its first substep only. holdOf() of contact_look.glsl goes by it; TURNING:
// see bodies.glsl.
#define WORKGROUP 64
layout(local_size_x = WORKGROUP) in;

#include "kernels/lanes_glsl.h"
#include "kernels/rotation.h"
#include "kernels/contact.h"
#include "kernels/distance_field.h"
#include "kernels/rod.h"
#include "gpu_compute/shaders/step_input.glsl"
#include "gpu_compute/shaders/strand_offsets.glsl"
#include "gpu_compute/shaders/bodies.glsl"
#include "gpu_compute/shaders/root_cover.glsl"
#include "gpu_compute/shaders/contact_sights.glsl"
#include "gpu_compute/shaders/root_poses.glsl"
#include "gpu_compute/shaders/root_motion.glsl"
layout(std430, binding = 0) readonly buffer Positions { vec4 positions[]; };    // xyz, m
layout(std430, binding = 1) readonly buffer Velocities { vec4 velocities[]; };  // xyz, m/s; w: rest distance from bodies, m
layout(std430, binding = 11) readonly buffer Edges { vec4 edge_rest[]; };       // length, ...
layout(location = 0) uniform int substep;
layout(location = 1) uniform bool sorted;  // later substeps are of near strands only

void main() {
  const uint strand = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * uint(WORKGROUP) + gl_LocalInvocationID.x;
  if (strand >= settings.strand_count) return;
  const uint root = offsets[strand];
  if (substep > 0 && sorted && isClear(strand)) return;
  const RootPoses poses = rootPoses(strand);
  const RootMotion motion = motionOfRoot(poses, substep, 0, positions[root].xyz, velocities[root].xyz);
  contacts[sightAt(root, kRootPosition)] = vec4(motion.position, motion.jump.x);
  contacts[sightAt(root, kRootTangent)] = vec4(motion.tangent_old, motion.jump.y);
  contacts[sightAt(root, kRootRotation)] = motion.rotation;
  Cover cover = Cover(0u, 0.0, 0.0);
  if (substep == 0 || contacts[sightAt(root, kLooked)].w > 0.0) {
    const vec3 from = poses.begin.position;
    const vec3 start = substep > 0 ? madd(poses.end.position - from, timeAfter(substep - 1), from) : from;
    const float first_edge = edge_rest[root].x;
    cover = coverOf(strand, start, motion.position, clearance(velocities[root]), first_edge, substep);
    const float way_out = wayOutOf(cover.most);
    if (substep == 0) contacts[sightAt(root, kLooked)].w = way_out > first_edge ? way_out : 0.0;
  }
  contacts[sightAt(root, kCover)] = vec4(float(cover.bodies), cover.depth, motion.spin, motion.jump.z);
}
