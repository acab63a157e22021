#version 450
// variants: SHAPE_KINDS=0 | SHAPE_KINDS=1 | SHAPE_KINDS=2
// Motion of the roots in a substep, and the bodies that cover them. The first pass of a substep among bodies.
// Reads: poses of bones, positions and velocities of roots, bodies.
// Writes: the roots' rows of the contact cache, for the later passes of the substep: rootHoldOf() of contact_query.glsl,
// knownRoot() of rod_contact.glsl.
// One invocation per strand. After the first substep, roots that no body can cover in the step skip the cover test.
// SHAPE_KINDS: 0 to 2, see bodies.glsl.
#define WORKGROUP 64
layout(local_size_x = WORKGROUP) in;

#include "kernels/lanes_glsl.h"
#include "kernels/rotation.h"
#include "kernels/contact.h"
#include "kernels/distance_field.h"
#include "kernels/rod.h"
#include "gpu_compute/shaders/step_input.glsl"
#include "gpu_compute/shaders/bodies.glsl"
#include "gpu_compute/shaders/contact_cache.glsl"
#include "gpu_compute/shaders/root_motion.glsl"
layout(std430, binding = 0) readonly buffer Positions { vec4 positions[]; };    // xyz, m
layout(std430, binding = 1) readonly buffer Velocities { vec4 velocities[]; };  // xyz, m/s; w: rest distance from bodies, m
layout(std430, binding = 11) readonly buffer Edges { vec4 edge_rest[]; };       // x: length, m
layout(location = 0) uniform int substep;
layout(location = 1) uniform bool sorted;  // contact-free strands skip the substeps after the first

void main() {
  const uint strand = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * uint(WORKGROUP) + gl_LocalInvocationID.x;
  if (strand >= settings.strand_count) return;
  const uint root = offsets[strand];
  if (substep > 0 && sorted && isContactFree(strand)) return;
  const RootPoses poses = rootPoses(strand);
  const RootMotion motion = motionOfRoot(poses, substep, 0, positions[root].xyz, velocities[root].xyz);
  contacts[contactRow(root, kRootPosition)] = vec4(motion.position, motion.jump.x);
  contacts[contactRow(root, kRootTangent)] = vec4(motion.tangent_old, motion.jump.y);
  contacts[contactRow(root, kRootRotation)] = motion.rotation;
  Cover cover = Cover(0u, 0.0, 0.0);
  if (substep == 0 || contacts[contactRow(root, kQueryPoint)].w > 0.0) {
    const vec3 from = poses.begin.position;
    const vec3 start = substep > 0 ? madd(poses.end.position - from, timeAfter(substep - 1), from) : from;
    const float first_edge = edge_rest[root].x;
    cover = coverOf(strand, start, motion.position, clearance(velocities[root]), first_edge, substep);
    const float way_out = exitArcLength(cover.most);
    if (substep == 0) contacts[contactRow(root, kQueryPoint)].w = way_out > first_edge ? way_out : 0.0;
  }
  contacts[contactRow(root, kCover)] = vec4(float(cover.bodies), cover.depth, motion.spin, motion.jump.z);
}
