#version 450
// Where the bones take the strands' roots: their poses at the start and at the end of the step, for all that follows in it.
#define WORKGROUP 64
layout(local_size_x = WORKGROUP) in;

#include "kernels/lanes_glsl.h"
#include "kernels/rotation.h"
#define ROOTS_ACCESS
#include "gpu_compute/shaders/step_input.glsl"
#include "gpu_compute/shaders/strand_offsets.glsl"

void carryRoot(Pose rest, Pose bone, uint to) {
  const vec3 position = rotate(bone.rotation, rest.position) + bone.position;
  const vec4 rotation = multiply(bone.rotation, rest.rotation);
  for (uint c = 0u; c < 3u; ++c) roots[7u * to + c] = position[c];
  for (uint c = 0u; c < 4u; ++c) roots[7u * to + 3u + c] = rotation[c];
}

void main() {
  const uint strand = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * uint(WORKGROUP) + gl_LocalInvocationID.x;
  const uint strands = settings.strand_count, bones = settings.bone_count;
  if (strand >= strands) return;
  const Pose rest = rootPose(2u * (strands + bones) + strand);
  const uint bone = 2u * strands + offsets[2u * strands + 1u + strand];
  carryRoot(rest, rootPose(bone), strand);
  carryRoot(rest, rootPose(bone + bones), strands + strand);
}
