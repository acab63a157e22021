// A bound hair: the formula of BoundHairReference (groom/bound_growth.h).
#include "render/shaders/hair_curve.glsl"
struct BoundHair {
  uint first, count;
  float arc_length;  // m, at rest
  uint unused;
};
layout(std430, binding = 12) readonly buffer NodeMotions { vec4 motions[]; };
layout(std430, binding = 13) readonly buffer BoundHairs { BoundHair bound_hairs[]; };
// Two for each vertex, then two numbers for each: see BoundBodyNumbers in render/bound_hairs.cc.
layout(std430, binding = 14) BOUND_ACCESS buffer BoundVertices { vec4 bound_vertices[]; };
uniform uint vertex_count;

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

// `closing`: share, 0 to 1, by which the hair follows its first guide alone because of bodies.
Carried boundPoint(Hair hair, float arc_length, uint vertex, float closing) {
  vec4 rest_along = bound_vertices[2u * vertex];
  vec3 tangent = bound_vertices[2u * vertex + 1u].xyz;
  Carried sum = Carried(vec3(0), vec3(0), true);
  vec2 others = hair.weights * (1.0 - closing);
  float weights[3] = float[3](1.0 - others.x - others.y, others.x, others.y);
  for (int k = 0; k < 3; ++k) carry(sum, hair.guides[k], weights[k], rest_along.w, arc_length, rest_along.xyz, tangent);
  return sum;
}

// Distance of a vertex from bodies at rest, m, and its closing because of bodies. kClear instead: no body is near.
const float kClear = -1.0;
vec2 bodyNumbers(uint vertex) {
  vec4 pair = bound_vertices[2u * vertex_count + vertex / 2u];
  return (vertex & 1u) == 0u ? pair.xy : pair.zw;
}
