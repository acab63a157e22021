#version 450 core
// variants: none | REST=1 | CARRY=1
// One invocation evaluates one guide from root to tip; see guide_nodes.h. REST: its nodes at rest. CARRY: their
// rotations from there, too.
layout(local_size_x = 32) in;
#include "kernels/lanes_glsl.h"
#include "kernels/rotation.h"
#include "kernels/hair.h"

struct Guide {
  uint first, count, usable, carried;
  vec4 root_normal;                   // w: length of the guide at rest, m
  vec4 root_rotation, root_position;  // its motion from rest
};
layout(std430, binding = 0) readonly buffer GuidePositions { float positions[]; };
layout(std430, binding = 1) readonly buffer GuideKnots { float knots[]; };
layout(std430, binding = 2) readonly buffer Guides { Guide guides[]; };
layout(std430, binding = 3) buffer Nodes { vec4 nodes[]; };
#if defined(REST) || defined(CARRY)
// Position at rest (w: length, -1 unusable), position (w: 1 where usable), rotation.
layout(std430, binding = 12) buffer NodeMotions { vec4 motions[]; };
#endif
uniform mat4 head_rotation;
uniform uint guide_count;
uniform uint segments;

vec3 vertexAt(uint v) { return vec3(positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]); }

// The edge that contains the parameter u, by bisection. The step count is the same for every guide, for up to 65,537
// vertices: Mesa's software pipeline was observed to keep executing finished invocations while their neighbours were
// active.
uint edgeAt(Guide guide, float u) {
  uint low = 0u, high = guide.count - 1u;
  for (int step = 0; step < 16; ++step) {
    uint middle = (low + high) / 2u;
    bool beyond = middle + 1u < guide.count && knots[guide.first + middle] <= u;
    low = beyond ? middle : low;
    high = beyond ? high : middle;
  }
  return min(low, guide.count - 2u);
}

// Catmull-Rom tangent with non-uniform knots; one-sided at the ends.
vec3 tangentAt(Guide guide, uint i) {
  uint low = guide.first + (i == 0u ? 0u : i - 1u);
  uint high = guide.first + min(i + 1u, guide.count - 1u);
  return (vertexAt(high) - vertexAt(low)) / max(knots[high] - knots[low], 1e-6);
}

vec3 unitOr(vec3 v, vec3 fallback) {
  vec3 unit = normalizeOrZero(v);
  return dot(unit, unit) > 0.5 ? unit : fallback;
}

vec3 anyNormal(vec3 unit) {
  vec3 other = abs(unit.y) < 0.9 ? vec3(0, 1, 0) : vec3(1, 0, 0);
  return normalize(other - unit * dot(other, unit));
}

#ifdef CARRY
// Unit secants about a node over an eighth of the guide's nodes to both sides; edges of received guides are noisy.
void secantsAt(uint guide, uint node, out vec3 rest, out vec3 present) {
  uint reach = max(segments / 8u, 1u), first = guide * (segments + 1u);
  uint low = first + node - min(node, reach), high = first + min(node + reach, segments);
  rest = normalizeOrZero(motions[3u * high].xyz - motions[3u * low].xyz);
  present = normalizeOrZero(motions[3u * high + 1u].xyz - motions[3u * low + 1u].xyz);
}

// As BoundHairReference (groom/bound_growth.h): the root's rotation stays as given, a clamped root bends behind it.
void carryMotion(uint guide, quat rotation, vec3 moved) {
  uint first = guide * (segments + 1u);
  float farthest = 0.0;
  for (uint node = first; node <= first + segments; ++node)
    farthest = max(farthest, distance(nodes[3u * node].xyz, carriedPoint(moved, rotation, vec3(0), motions[3u * node].xyz)));
  float share = motionShare(farthest);
  for (uint node = first; node <= first + segments; ++node) {
    vec3 rest = carriedPoint(moved, rotation, vec3(0), motions[3u * node].xyz);
    motions[3u * node + 1u] = vec4(settledNode(nodes[3u * node].xyz, rest, share), 1);
  }
  for (uint i = 0u; i <= segments; ++i) {
    vec3 rest, present;
    secantsAt(guide, i, rest, present);
    if (i > 0u) rotation = nodeRotation(rotation, rest, present);
    motions[3u * (first + i) + 2u] = vec4(rotation.x, rotation.y, rotation.z, rotation.w);
  }
}
#endif

void main() {
  uint g = gl_GlobalInvocationID.x;
  if (g >= guide_count) return;
  Guide guide = guides[g];
  uint base = g * (segments + 1u) * 3u;
  if (guide.usable == 0u) {
    for (uint i = 0u; i < 3u * (segments + 1u); ++i) nodes[base + i] = vec4(0);
#ifdef REST
    for (uint i = 0u; i <= segments; ++i) motions[3u * (g * (segments + 1u) + i)] = vec4(0, 0, 0, -1);
#endif
#ifdef CARRY
    for (uint i = 0u; i <= segments; ++i) motions[3u * (g * (segments + 1u) + i) + 1u] = vec4(0);
#endif
    return;
  }
  vec3 last_position = vertexAt(guide.first), last_tangent = unitOr(tangentAt(guide, 0u), vec3(0, -1, 0));
  vec3 normal = guide.root_normal.xyz;
  if (guide.carried == 0u) normal = mat3(head_rotation) * normal;
  for (uint i = 0u; i <= segments; ++i) {
    float u = float(i) / float(segments);
    uint k = edgeAt(guide, u);
    vec3 m0 = tangentAt(guide, k), m1 = tangentAt(guide, k + 1u);
    uint v = guide.first + k;
    vec3 p0 = vertexAt(v), p1 = vertexAt(v + 1u);
    float t0 = knots[v], h = max(knots[v + 1u] - t0, 1e-6), s = clamp((u - t0) / h, 0.0, 1.0);
    vec3 position = splinePosition(p0, p1, m0, m1, h, s), derivative = splineDerivative(p0, p1, m0, m1, h, s);
    vec3 tangent = unitOr(derivative, last_tangent);
    normal = unitOr(carriedNormal(normal, last_tangent, position - last_position, tangent), anyNormal(tangent));
    last_position = position;
    last_tangent = tangent;
#ifdef REST
    motions[3u * (g * (segments + 1u) + i)] = vec4(position, guide.root_normal.w);
#else
    nodes[base + 3u * i] = vec4(position, 1);
    nodes[base + 3u * i + 1u] = vec4(derivative, 0);
    nodes[base + 3u * i + 2u] = vec4(normal, 0);
#endif
  }
#ifdef CARRY
  vec4 root = guide.root_rotation;
  carryMotion(g, normalizeQuat(makeQuat(root.x, root.y, root.z, root.w)), guide.root_position.xyz);
#endif
}
