// Vertices that look at bodies at the start of a substep, from where they would go by themselves. Needs step_input.glsl,
// strand_offsets.glsl, root_poses.glsl, kernels/contact.h and bodies.glsl.
layout(std430, binding = 0) readonly buffer Positions { vec4 positions[]; };    // xyz, m
layout(std430, binding = 1) readonly buffer Velocities { vec4 velocities[]; };  // xyz, m/s; w: rest distance from bodies, m
layout(std430, binding = 5) buffer Work { uint work[]; };  // how many vertices look; the vertices
layout(location = 0) uniform uint looks_count;             // places in it
layout(location = 1) uniform uint looks_list;
layout(location = 4) uniform int substep;

// A vertex in the list: its strand and its number in it, which is less than 128.
uint listed(uint strand, uint number) { return strand << 7u | number; }
uint strandOf(uint entry) { return entry >> 7u; }
uint numberOf(uint entry) { return entry & 127u; }

// Unexpected motion of the strand's root in the substep, m: its vertices go along with it.
vec3 jumpOf(uint strand) {
  uint root = offsets[strand];
  const RootPoses poses = rootPoses(strand);
  const vec3 from = poses.begin.position;
  vec3 root_position = madd(poses.end.position - from, timeAfter(substep), from);
  return root_position - madd(velocities[root].xyz, settings.substep, positions[root].xyz);
}
vec3 aheadOf(uint vertex, vec3 jump) {
  return madd(velocities[vertex].xyz, settings.substep * settings.keep, positions[vertex].xyz) + jump;
}
