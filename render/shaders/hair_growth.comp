#version 450 core
// variants: none | BODIES=1
// One invocation grows one vertex of one hair; HairVertices in render/hair_pass.h has the layout.
layout(local_size_x = 256) in;
#define HAIR_BODIES_ACCESS readonly
#include "render/shaders/hair_curve.glsl"
layout(std430, binding = 5) writeonly buffer HairVertices { vec4 hair_vertices[]; };
uniform uint first_hair;
uniform uint hair_count;  // from the first hair of the list
uniform uint nodes_per_hair;
uniform uint node_stride;

void main() {
  uint i = gl_GlobalInvocationID.x, in_chunk = i / nodes_per_hair;
  if (in_chunk >= hair_count) return;
  uint index = first_hair + in_chunk, node = min((i - in_chunk * nodes_per_hair) * node_stride, growth.segments);
  Hair hair = hairs[hair_list[index]];
#ifdef BODIES
  HairPoint point = grownHair(index, hair, node);
#else
  HairPoint point = freeHair(hair, node, vec2(0));
#endif
  hair_vertices[2u * i] = vec4(point.position, point.along);
  hair_vertices[2u * i + 1u] =
      vec4(normalize(point.derivative + vec3(0, 1e-12, 0)), point.usable ? hairTaper(point.along) : -1.0);
}
