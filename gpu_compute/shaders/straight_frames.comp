#version 450
// Material frames of strands that are straight at rest, by parallel transport of the first edge's frame along the edges.
// rod.comp with STRAIGHT keeps only the first frame; this pass runs before a download or before a step among bodies.
// Reads: positions, the frame of each strand's first edge. Writes: the frames of its other edges.
// One invocation per strand.
layout(local_size_x = 32) in;

#include "kernels/lanes_glsl.h"
#include "kernels/rotation.h"
#include "kernels/rod.h"

layout(std430, binding = 4) readonly buffer Offsets { uint offsets[]; };      // see step_input.glsl
layout(std430, binding = 0) readonly buffer Positions { vec4 positions[]; };  // see rod_strand.glsl, as all here
layout(std430, binding = 5) readonly buffer Work { uint work[]; };
layout(std430, binding = 9) buffer Frames { vec4 frames[]; };
layout(location = 0) uniform uint first;  // in work[]
layout(location = 1) uniform uint count;

void main() {
  const uint number = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
  const uint own = number * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
  if (own >= count) return;
  const uint strand = work[first + own];
  vec4 frame = frames[offsets[strand]];
  vec3 t_in = frameTangent(frame);
  for (uint v = offsets[strand]; v + 1u < offsets[strand + 1u]; ++v) {
    const vec3 t = directionOr(positions[v + 1u].xyz - positions[v].xyz, t_in);
    frames[v] = frame = transportTo(frame, t_in, t);
    t_in = t;
  }
}
