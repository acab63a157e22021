#version 450
// Copies a buffer to measure the GPU's memory bandwidth. Adjacent invocations access adjacent elements (coalesced).
layout(local_size_x = 256) in;
layout(std430, binding = 0) readonly buffer From { vec4 from[]; };
layout(std430, binding = 1) writeonly buffer To { vec4 to[]; };

void main() {
  const uint invocations = gl_NumWorkGroups.x * gl_WorkGroupSize.x;
  for (uint i = gl_GlobalInvocationID.x; i < uint(from.length()); i += invocations) to[i] = from[i];
}
