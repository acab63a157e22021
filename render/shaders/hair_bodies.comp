#version 450 core
// One invocation computes, for one hair, how far it follows one guide instead of three to stay out of bodies; see
// hair_bodies.h.
layout(local_size_x = 64) in;
#define BODIES
#define HAIR_BODIES_ACCESS
#include "render/shaders/hair_curve.glsl"
uniform uint hair_count;

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index >= hair_count) return;
  Hair hair = hairs[hair_list[index]];
  uint at = index * (growth.segments + 2u);
  float root_distance = 0.0;
  for (uint node = 0u; node <= growth.segments; ++node) {
    HairPoint point = freeHair(hair, node, vec2(0));
    vec3 normal;
    float distance = bodyDistance(point.position, normal);
    if (node == 0u) root_distance = distance;
    hair_bodies[at + 1u + node] = closingAsked(keptDistance(point.u, root_distance, 0.0) - distance);
  }
  hair_bodies[at] = root_distance;
  // Propagates each vertex's closing to all vertices after it and, within the zone, to those before it.
  uint zone = uint(growth.zone * float(growth.segments));
  float most = 0.0;
  for (uint node = 0u; node <= growth.segments; ++node) {
    most = max(most, hair_bodies[at + 1u + node]);
    float closing = most;
    for (uint ahead = 1u; ahead <= zone; ++ahead) {
      uint other = min(node + ahead, growth.segments);
      closing = max(closing, closingBefore(hair_bodies[at + 1u + other], float(ahead) / float(growth.segments), growth.zone));
    }
    hair_bodies[at + 1u + node] = closing;
  }
}
