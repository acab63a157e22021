#version 450 core
// One invocation finds where one hair has to leave its three guides for one, because it would go into a body; see
// hair_bodies.h.
layout(local_size_x = 64) in;
#define BODIES
#define FIND_SWITCH
#include "render/shaders/hair_curve.glsl"
uniform uint hair_count;

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index >= hair_count) return;
  Hair hair = hairs[index];
  float root_distance = 0.0, from = kNoSwitch;
  for (uint node = 0u; node <= growth.segments; ++node) {
    HairPoint point = freeHair(hair, node, kNoSwitch);
    vec3 normal;
    float distance = bodyDistance(point.position, normal);
    if (node == 0u) root_distance = distance;
    float depth = keptDistance(point.u, root_distance, 0.0) - distance;
    from = min(from, switchBefore(point.u, depth, growth.zone));
  }
  hair_bodies[index] = vec2(from, root_distance);
}
