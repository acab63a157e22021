#version 450 core
// variants: none | AMONG_BODIES=1
// One invocation grows one vertex of one bound hair. HairVertices in render/hair_pass.h has the layout.
layout(local_size_x = 256) in;
#define BOUND_ACCESS readonly
#include "render/shaders/bound_curve.glsl"
#ifdef AMONG_BODIES
#include "render/shaders/bodies.glsl"
#endif
layout(std430, binding = 5) writeonly buffer HairVertices { vec4 hair_vertices[]; };
uniform uint first_hair;
uniform uint hair_count;  // from the first hair of the list
uniform uint nodes_per_hair;
uniform uint node_stride;

void main() {
  uint i = gl_GlobalInvocationID.x, in_chunk = i / nodes_per_hair;
  if (in_chunk >= hair_count) return;
  Hair hair = hairs[hair_list[first_hair + in_chunk]];
  BoundHair bound = bound_hairs[hair.bound - 1u];
  // A hair of fewer vertices collapses onto its tip: degenerate lines, not drawn.
  uint vertex = bound.first + min((i - in_chunk * nodes_per_hair) * node_stride, bound.count - 1u);
#ifdef AMONG_BODIES
  vec2 numbers = bodyNumbers(vertex);
  Carried sum = boundPoint(hair, bound.arc_length, vertex, max(numbers.y, 0.0));
  float kept = min(numbers.x, growth.clearance);
  for (int again = 0; again < 3 && numbers.y != kClear; ++again) {
    vec3 normal;
    float distance = bodyDistance(sum.position, normal);
    if (distance >= kept) break;
    sum.position += normal * (kept - distance);
  }
#else
  Carried sum = boundPoint(hair, bound.arc_length, vertex, 0.0);
#endif
  float width = bound_vertices[2u * vertex + 1u].w;
  hair_vertices[2u * i] = vec4(sum.position, bound_vertices[2u * vertex].w);
  hair_vertices[2u * i + 1u] = vec4(normalizeOrZero(sum.tangent), sum.usable ? width : -1.0);
}
