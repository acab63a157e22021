#version 450 core
// One invocation evaluates one guide from root to tip; see guide_nodes.h.
layout(local_size_x = 32) in;

struct Guide {
  uint first, count, usable, unused;
  vec4 rest_normal;
};
layout(std430, binding = 0) readonly buffer GuidePositions { float positions[]; };
layout(std430, binding = 1) readonly buffer GuideKnots { float knots[]; };
layout(std430, binding = 2) readonly buffer Guides { Guide guides[]; };
layout(std430, binding = 3) writeonly buffer Nodes { vec4 nodes[]; };
uniform mat4 head_rotation;
uniform uint guide_count;
uniform uint segments;

vec3 vertexAt(uint v) { return vec3(positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]); }

// The edge that the parameter u lies on. The same number of steps for every guide, up to 65,537 vertices: Mesa's software
// pipeline has been seen to go on walking with guides that were done while their neighbours were not.
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

vec3 perpendicular(vec3 v, vec3 unit) { return v - unit * dot(v, unit); }

vec3 unitOr(vec3 v, vec3 fallback) {
  float length_squared = dot(v, v);
  return length_squared > 1e-18 ? v * inversesqrt(length_squared) : fallback;
}

vec3 anyNormal(vec3 unit) {
  return normalize(perpendicular(abs(unit.y) < 0.9 ? vec3(0, 1, 0) : vec3(1, 0, 0), unit));
}

void main() {
  uint g = gl_GlobalInvocationID.x;
  if (g >= guide_count) return;
  Guide guide = guides[g];
  uint base = g * (segments + 1u) * 3u;
  if (guide.usable == 0u) {
    for (uint i = 0u; i < 3u * (segments + 1u); ++i) nodes[base + i] = vec4(0);
    return;
  }
  vec3 last_position = vertexAt(guide.first), last_tangent = unitOr(tangentAt(guide, 0u), vec3(0, -1, 0));
  vec3 normal = perpendicular(mat3(head_rotation) * guide.rest_normal.xyz, last_tangent);
  normal = unitOr(normal, anyNormal(last_tangent));
  for (uint i = 0u; i <= segments; ++i) {
    float u = float(i) / float(segments);
    uint k = edgeAt(guide, u);
    vec3 m0 = tangentAt(guide, k), m1 = tangentAt(guide, k + 1u);
    uint v = guide.first + k;
    vec3 p0 = vertexAt(v), p1 = vertexAt(v + 1u);
    float t0 = knots[v], h = max(knots[v + 1u] - t0, 1e-6);
    float s = clamp((u - t0) / h, 0.0, 1.0), s2 = s * s, s3 = s2 * s;
    // Written from p0, so that coordinates far from the origin do not cost digits.
    vec3 position = p0 + (3.0 * s2 - 2.0 * s3) * (p1 - p0) + h * ((s3 - 2.0 * s2 + s) * m0 + (s3 - s2) * m1);
    vec3 derivative = (6.0 * s - 6.0 * s2) / h * (p1 - p0) + (3.0 * s2 - 4.0 * s + 1.0) * m0 + (3.0 * s2 - 2.0 * s) * m1;
    vec3 tangent = unitOr(derivative, last_tangent);
    // Double reflection: through the plane between the points, then through the one between the tangents.
    vec3 v1 = position - last_position;
    float c1 = dot(v1, v1);
    if (c1 > 1e-16) {
      vec3 n = normal - v1 * (2.0 / c1 * dot(v1, normal));
      vec3 t = last_tangent - v1 * (2.0 / c1 * dot(v1, last_tangent));
      vec3 v2 = tangent - t;
      float c2 = dot(v2, v2);
      normal = c2 > 1e-16 ? n - v2 * (2.0 / c2 * dot(v2, n)) : n;
    }
    normal = unitOr(perpendicular(normal, tangent), anyNormal(tangent));
    last_position = position;
    last_tangent = tangent;
    nodes[base + 3u * i] = vec4(position, 1);
    nodes[base + 3u * i + 1u] = vec4(derivative, 0);
    nodes[base + 3u * i + 2u] = vec4(normal, 0);
  }
}
