#version 450
// variants: TURNING=0 | TURNING=1
// Every vertex looks at the bodies of a substep, from where it would go by itself. A workgroup does a strand.
// TURNING: see bodies.glsl.
#define WORKGROUP 32
layout(local_size_x = WORKGROUP) in;

#include "kernels/lanes_glsl.h"
#include "kernels/rotation.h"
#include "kernels/contact.h"
#include "kernels/distance_field.h"
#include "gpu_compute/shaders/step_input.glsl"
#include "gpu_compute/shaders/strand_offsets.glsl"
#include "gpu_compute/shaders/bodies.glsl"
#include "gpu_compute/shaders/contact_sights.glsl"
#include "gpu_compute/shaders/contact_look.glsl"
layout(std430, binding = 0) readonly buffer Positions { vec4 positions[]; };    // xyz, m
layout(std430, binding = 1) readonly buffer Velocities { vec4 velocities[]; };  // xyz, m/s; w: rest distance from bodies, m
layout(location = 4) uniform int substep;

void main() {
  uint strand = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
  if (strand >= settings.strand_count) return;
  uint root = offsets[strand], end = offsets[strand + 1u];
  vec3 from = rootPose(strand).position, to = rootPose(settings.strand_count + strand).position;
  vec3 root_position = madd(to - from, timeAfter(substep), from);
  vec3 jump = root_position - madd(velocities[root].xyz, settings.substep, positions[root].xyz);
  for (uint vertex = root + 1u + gl_LocalInvocationID.x; vertex < end; vertex += uint(WORKGROUP)) {
    vec4 velocity = velocities[vertex];
    vec3 start = positions[vertex].xyz;
    vec3 ahead = madd(velocity.xyz, settings.substep * settings.keep, start) + jump;
    look(strand, vertex, ahead, start, clearance(velocity), substep);
  }
}
