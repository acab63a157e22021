#version 450 core
// Lists the fragments that hair_opacity.frag accumulates: for LightProbe in render/shader_validation.h.
layout(location = 2) in float coverage;
layout(std430, binding = 9) buffer Fragments {
  uint count, room, unused[2];
  vec4 fragments[];  // x and y of the texel, depth 0 to 1, optical depth
};
void main() {
  uint at = atomicAdd(count, 1u);
  if (at < room) fragments[at] = vec4(floor(gl_FragCoord.xy), gl_FragCoord.z, coverage);
}
