#version 450
// variants: TURNING=0 | TURNING=1 | TURNING=2
// The listed vertices look at the bodies of a substep. TURNING: see bodies.glsl.
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
#include "gpu_compute/shaders/contact_look.glsl"
#include "gpu_compute/shaders/root_poses.glsl"
#include "gpu_compute/shaders/look_ahead.glsl"

void main() {
  const uint count = work[looks_count];
  for (uint at = gl_GlobalInvocationID.x; at < count; at += gl_NumWorkGroups.x * uint(WORKGROUP)) {
    uint entry = work[looks_list + at], strand = strandOf(entry), vertex = offsets[strand] + numberOf(entry);
    look(strand, vertex, aheadOf(vertex, jumpOf(strand)), positions[vertex].xyz, clearance(velocities[vertex]), substep);
  }
}
