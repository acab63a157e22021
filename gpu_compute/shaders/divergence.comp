#version 450
// Whether a strand may have diverged: Backend::mayHaveDiverged() of core/backend.h.
// Reads: guides. Writes: one word. Eight invocations per strand, 32 strands per workgroup.
layout(local_size_x = 256) in;

layout(std430, binding = 0) readonly buffer Guides { float guides[]; };               // 3 per vertex, m
layout(std430, binding = 1) readonly buffer Offsets { uint offsets[]; };              // first vertex per strand, and the end
layout(std430, binding = 2) readonly buffer SquaredReach { float squared_reach[]; };  // per strand, m^2
layout(std430, binding = 3) buffer Found { uint found; };                             // 0 before; 1: a strand exceeds its reach
layout(location = 0) uniform uint strands;

vec3 guideAt(uint vertex) { return vec3(guides[3u * vertex], guides[3u * vertex + 1u], guides[3u * vertex + 2u]); }

// By bits: compilers may assume that floats are finite.
bool isFinite(vec3 p) {
  const uvec3 exponents = floatBitsToUint(p) & 0x7f800000u;
  return max(exponents.x, max(exponents.y, exponents.z)) != 0x7f800000u;
}

void main() {
  const uint workgroup = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
  const uint strand = workgroup * 32u + gl_LocalInvocationID.x / 8u;
  if (strand >= strands) return;
  const uint first = offsets[strand], end = offsets[strand + 1u];
  const vec3 root = guideAt(first);
  bool good = isFinite(root);
  for (uint vertex = first + gl_LocalInvocationID.x % 8u; vertex < end; vertex += 8u) {
    const vec3 p = guideAt(vertex), from_root = p - root;
    good = good && isFinite(p) && dot(from_root, from_root) <= squared_reach[strand];
  }
  if (!good) atomicOr(found, 1u);
}
