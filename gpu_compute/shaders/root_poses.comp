#version 450
// Where the bones take the strands' roots: their poses at the start and at the end of the step, for all that follows in it.
#define WORKGROUP 64
layout(local_size_x = WORKGROUP) in;

#include "kernels/lanes_glsl.h"
#include "kernels/rotation.h"
#include "gpu_compute/shaders/strand_offsets.glsl"
layout(std430, binding = 6) buffer Poses { float poses[]; };  // see step_input.glsl
layout(location = 0) uniform uint strands;
layout(location = 1) uniform uint bones;

void carryRoot(uint strand, uint bone, uint to) {
  const uint rest = 7u * (2u * (strands + bones) + strand), by = 7u * bone, at = 7u * to;
  const vec3 local = vec3(poses[rest], poses[rest + 1u], poses[rest + 2u]);
  const vec4 local_rotation = vec4(poses[rest + 3u], poses[rest + 4u], poses[rest + 5u], poses[rest + 6u]);
  const vec4 rotation = vec4(poses[by + 3u], poses[by + 4u], poses[by + 5u], poses[by + 6u]);
  const vec3 position = rotate(rotation, local) + vec3(poses[by], poses[by + 1u], poses[by + 2u]);
  const vec4 carried = multiply(rotation, local_rotation);
  for (uint c = 0u; c < 3u; ++c) poses[at + c] = position[c];
  for (uint c = 0u; c < 4u; ++c) poses[at + 3u + c] = carried[c];
}

void main() {
  const uint strand = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * uint(WORKGROUP) + gl_LocalInvocationID.x;
  if (strand >= strands) return;
  const uint bone = 2u * strands + offsets[2u * strands + 1u + strand];
  carryRoot(strand, bone, strand);
  carryRoot(strand, bone + bones, strands + strand);
}
