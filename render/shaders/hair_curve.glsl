// A hair as render/hair_growth.h defines it, evaluated at the nodes of its guides (render/guide_nodes.h).
struct Hair {
  uvec3 guides;
  float dither;
  vec3 weights;
  float clump;
  vec2 offset;
  float extent;
  float width;
  float stray;
  float phase;
  float shade;
  float warmth;
};
layout(std430, binding = 3) readonly buffer Nodes { vec4 nodes[]; };
layout(std430, binding = 4) readonly buffer Hairs { Hair hairs[]; };
uniform uint segments;  // of the guides' nodes

struct HairPoint {
  vec3 position;
  vec3 derivative;  // along u, up to a part along the tangent
  float u;          // part of the guide's length
  float width;      // times hair_width, with the taper at the tip
  bool usable;
};

HairPoint evaluateHair(Hair hair, uint wanted_node) {
  HairPoint point;
  float last = hair.extent * float(segments);
  // Nodes past the tip fall on the first one past it: lines of no length, not drawn.
  uint node = min(wanted_node, min(uint(ceil(last)), segments));
  float u = float(node) / float(segments);
  uint stride = 3u * (segments + 1u);
  uint a = hair.guides.x * stride + 3u * node;
  uint b = hair.guides.y * stride + 3u * node;
  uint c = hair.guides.z * stride + 3u * node;
  vec4 pa = nodes[a], pb = nodes[b], pc = nodes[c];
  vec3 da = nodes[a + 1u].xyz, db = nodes[b + 1u].xyz, dc = nodes[c + 1u].xyz;
  vec3 normal = nodes[a + 2u].xyz;
  point.usable = pa.w * pb.w * pc.w > 0.5;

  float closing = hair.clump * u;
  vec2 w = (1.0 - closing) * hair.weights.yz;  // the first follows from the sum
  vec2 dw = -hair.clump * hair.weights.yz;
  vec3 ab = pb.xyz - pa.xyz, ac = pc.xyz - pa.xyz;
  point.position = pa.xyz + w.x * ab + w.y * ac;
  point.derivative = da + w.x * (db - da) + w.y * (dc - da) + dw.x * ab + dw.y * ac;

  // The frame turns only about axes across the tangent, so its own derivative lies along the tangent and is left out.
  vec3 tangent = normalize(da + vec3(0, 1e-12, 0));
  vec3 binormal = cross(tangent, normal);
  float angle = hair.phase + 9.0 * u;
  vec2 turn = vec2(cos(angle), sin(angle));
  vec2 across = (1.0 - 0.6 * u) * hair.offset + hair.stray * u * u * turn;
  vec2 slope = -0.6 * hair.offset + hair.stray * (2.0 * u * turn + 9.0 * u * u * vec2(-turn.y, turn.x));
  point.position += across.x * normal + across.y * binormal;
  point.derivative += slope.x * normal + slope.y * binormal;
  point.u = u;
  point.width = hair.width * clamp(4.0 * (1.0 - float(node) / last), 0.0, 1.0);
  return point;
}
