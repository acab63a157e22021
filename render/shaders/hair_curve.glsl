// A hair as render/hair_growth.h and kernels/hair.h define it, evaluated at the nodes of its guides
// (render/guide_nodes.h). With BODIES its penetration into bodies is resolved (render/hair_bodies.h).
#include "kernels/lanes_glsl.h"
#include "kernels/rotation.h"
#include "kernels/hair.h"
struct Hair {
  uvec3 guides;
  float dither;
  vec2 weights;
  vec2 beside;
  vec2 offset;
  float clump;
  float extent;
  float width;
  float tip_deviation;
  float whole_deviation;
  float deviation_phase;
  float curl_phase;
  float curl_radius;
  float curl_turns;
  float shade;
  float warmth;
  float importance;
  float example_scale;
  float first_sample;
  uint color;
  uint bound;
  float reach;
  float unused;
};
layout(std430, binding = 3) readonly buffer Nodes { vec4 nodes[]; };
layout(std430, binding = 4) readonly buffer Hairs { Hair hairs[]; };
layout(std430, binding = 11) readonly buffer HairList { uint hair_list[]; };  // indices of this picture's hairs
const int kExampleParts = 256;                                                // CurlExample::kParts
// GrowthBlock in render/hair_growth.h, field for field.
layout(std140, binding = 1) uniform Growth {
  vec4 profile;
  uint segments;
  uint bodies;
  float clearance;
  float zone;
  vec4 example[kExampleParts + 1];  // CurlExample::samples
}
growth;

struct HairPoint {
  vec3 position;
  vec3 derivative;  // with respect to u, up to a component along the tangent
  float u;          // fraction of the guide's length
  float along;      // fraction of the hair's length
  bool usable;
};

AcrossGuide acrossGuide(Hair hair, float u, Closing closing) {
  AcrossGuide across = hairAcross(u, vec3(hair.offset, 0), growth.profile.xyz, hair.tip_deviation, hair.whole_deviation,
                                  hair.deviation_phase, hair.curl_radius, hair.curl_turns, hair.curl_phase);
  across = bothAcross(across, besideGuide(vec3(hair.beside, 0), closing));
  if (hair.example_scale <= 0.0) return across;
  float place = u * float(kExampleParts);
  int part = min(int(place), kExampleParts - 1);
  vec4 a = growth.example[part], b = growth.example[part + 1];
  return bothAcross(across, exampleAcross(vec3(a.xy, 0), vec3(b.xy, 0), vec3(a.zw, 0), vec3(b.zw, 0), 1.0 / float(kExampleParts),
                                          place - float(part), hair.curl_phase, hair.example_scale));
}

// `bodies`: closing on one guide because of bodies, 0 to 1, and its derivative with respect to u.
HairPoint freeHair(Hair hair, uint wanted_node, vec2 bodies) {
  HairPoint point;
  float last = hair.extent * float(growth.segments);
  // Nodes past the tip collapse onto the first one past it: degenerate lines, not drawn.
  uint node = min(wanted_node, min(uint(ceil(last)), growth.segments));
  float u = float(node) / float(growth.segments);
  uint stride = 3u * (growth.segments + 1u);
  uint a = hair.guides.x * stride + 3u * node;
  uint b = hair.guides.y * stride + 3u * node;
  uint c = hair.guides.z * stride + 3u * node;
  vec4 pa = nodes[a], pb = nodes[b], pc = nodes[c];
  vec3 da = nodes[a + 1u].xyz, normal = nodes[a + 2u].xyz;
  vec3 binormal = cross(normalizeOrZero(da), normal), ab = pb.xyz - pa.xyz, ac = pc.xyz - pa.xyz;
  Closing closing = hairClosing(u, hair.clump, bodies.x, bodies.y);
  AcrossGuide across = acrossGuide(hair, u, closing);
  point.position = hairPosition(pa.xyz, ab, ac, hair.weights.x, hair.weights.y, closing, across, normal, binormal);
  point.derivative = hairDerivative(da, nodes[b + 1u].xyz - da, nodes[c + 1u].xyz - da, ab, ac, hair.weights.x, hair.weights.y,
                                    closing, across, normal, binormal);
  point.u = u;
  point.along = float(node) / last;
  point.usable = pa.w * pb.w * pc.w > 0.5;
  return point;
}

#ifdef BODIES
#include "render/shaders/bodies.glsl"
// Per hair: distance of its root from the surface of bodies, m, then for every node its closing on one guide because of
// bodies.
layout(std430, binding = 8) HAIR_BODIES_ACCESS buffer HairBodies { float hair_bodies[]; };

HairPoint grownHair(uint index, Hair hair, uint node) {
  if (growth.bodies == 0u) return freeHair(hair, node, vec2(0));
  uint at = index * (growth.segments + 2u), low = max(node, 1u) - 1u, high = min(node + 1u, growth.segments);
  float slope = (hair_bodies[at + 1u + high] - hair_bodies[at + 1u + low]) * float(growth.segments) / float(high - low);
  HairPoint point = freeHair(hair, node, vec2(hair_bodies[at + 1u + node], slope));
  float kept = keptDistance(point.u, hair_bodies[at], growth.clearance);
  for (int again = 0; again < 3; ++again) {
    vec3 normal;
    float distance = bodyDistance(point.position, normal);
    point.position += normal * max(kept - distance, 0.0);
  }
  return point;
}
#endif
