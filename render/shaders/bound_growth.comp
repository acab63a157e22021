#version 450 core
// One invocation grows one vertex of one bound hair: the formula of BoundHairReference (groom/bound_growth.h).
// HairVertices in render/hair_pass.h has the layout.
layout(local_size_x = 256) in;
#include "render/shaders/hair_curve.glsl"
struct BoundHair {
  uint first, count;
  float arc_length;  // m, at rest
  uint unused;
};
layout(std430, binding = 5) writeonly buffer HairVertices { vec4 hair_vertices[]; };
layout(std430, binding = 12) readonly buffer NodeMotions { vec4 motions[]; };
layout(std430, binding = 13) readonly buffer BoundHairs { BoundHair bound_hairs[]; };
layout(std430, binding = 14) readonly buffer BoundVertices { vec4 bound_vertices[]; };
uniform uint first_hair;
uniform uint hair_count;  // from the first hair of the list
uniform uint nodes_per_hair;
uniform uint node_stride;

struct Carried {
  vec3 position, tangent;
  bool usable;
};

// Adds the share of one guide. `along`: fraction of the hair's length.
void carry(inout Carried sum, uint guide, float weight, float along, float arc_length, vec3 rest, vec3 tangent) {
  if (weight <= 0.0) return;
  uint first = guide * (growth.segments + 1u);
  float guide_length = motions[3u * first].w, place = placeOnGuide(along, arc_length, guide_length) * float(growth.segments);
  uint i = min(uint(place), growth.segments - 1u);
  float f = place - float(i);
  sum.usable = sum.usable && motions[3u * first + 1u].w > 0.5 && guide_length >= 0.0;
  for (uint end = 0u; end < 2u; ++end) {
    uint node = first + i + end;
    float share = weight * (end == 0u ? 1.0 - f : f);
    vec4 rotation = motions[3u * node + 2u];
    sum.position += share * carriedPoint(motions[3u * node + 1u].xyz, rotation, motions[3u * node].xyz, rest);
    sum.tangent += share * rotate(rotation, tangent);
  }
}

void main() {
  uint i = gl_GlobalInvocationID.x, in_chunk = i / nodes_per_hair;
  if (in_chunk >= hair_count) return;
  Hair hair = hairs[hair_list[first_hair + in_chunk]];
  BoundHair bound = bound_hairs[hair.bound - 1u];
  // A hair of fewer vertices collapses onto its tip: degenerate lines, not drawn.
  uint vertex = bound.first + min((i - in_chunk * nodes_per_hair) * node_stride, bound.count - 1u);
  vec4 rest_along = bound_vertices[2u * vertex], tangent_width = bound_vertices[2u * vertex + 1u];
  Carried sum = Carried(vec3(0), vec3(0), true);
  float weights[3] = float[3](1.0 - hair.weights.x - hair.weights.y, hair.weights.x, hair.weights.y);
  for (int k = 0; k < 3; ++k)
    carry(sum, hair.guides[k], weights[k], rest_along.w, bound.arc_length, rest_along.xyz, tangent_width.xyz);
  hair_vertices[2u * i] = vec4(sum.position, rest_along.w);
  hair_vertices[2u * i + 1u] = vec4(normalizeOrZero(sum.tangent), sum.usable ? tangent_width.w : -1.0);
}
