#version 450 core
// variants: GUIDES=1 | TANGENTS=1 | COLLIDED=1 | INSIDE=1
// Diagnostic marks over the picture; see Marks in render/hair_pass.h.
#define BODIES
#define HAIR_BODIES_ACCESS readonly
#include "render/shaders/scene.glsl"
#include "render/shaders/hair_curve.glsl"
layout(location = 0) out vec3 mark_color;
uniform uint nodes_per_hair;
uniform float size;  // of tangents m, of points pixels; COLLIDED also uses `reach`, m
uniform float reach;
#ifdef COLLIDED
layout(std430, binding = 0) readonly buffer GuidePositions { float positions[]; };
#endif
#ifdef INSIDE
layout(std430, binding = 5) readonly buffer HairVertices { vec4 hair_vertices[]; };
uniform uint first_hair;  // of the buffer, in the list
#endif

// Moves marks 3 mm towards the eye, so that they show on the surface they lie on.
void place(vec3 at, bool shown) {
  vec3 to_eye = normalize(scene.eye.xyz - at);
  gl_Position = shown ? scene.view_projection * vec4(at + 0.003 * scene.sampling.z * to_eye, 1) : vec4(2, 2, 2, 1);
}

vec3 colorOf(uint number) {
  vec3 turns = vec3(0.0, 0.33, 0.67) + float(number) * 0.618034;
  return 0.35 + 0.6 * abs(2.0 * fract(turns) - 1.0);
}

void main() {
#ifdef GUIDES
  uint guide = uint(gl_InstanceID), at = 3u * (guide * (growth.segments + 1u) + uint(gl_VertexID));
  mark_color = colorOf(guide);
  place(nodes[at].xyz, nodes[at].w > 0.5);
#endif
#ifdef TANGENTS
  // Two vertices for every fourth node; red, green and blue are the tangent's x, y and z components.
  uint guide = uint(gl_InstanceID), node = min(uint(gl_VertexID) / 2u * 4u, growth.segments);
  uint at = 3u * (guide * (growth.segments + 1u) + node);
  vec3 tangent = normalizeOrZero(nodes[at + 1u].xyz);
  mark_color = abs(tangent);
  place(nodes[at].xyz + float(gl_VertexID & 1) * size * tangent, nodes[at].w > 0.5);
#endif
#ifdef COLLIDED
  uint v = uint(gl_VertexID);
  vec3 at = vec3(positions[3u * v], positions[3u * v + 1u], positions[3u * v + 2u]), normal;
  float distance = bodyDistance(at, normal);
  mark_color = distance < 0.0 ? vec3(1, 0.1, 0.1) : vec3(1, 0.75, 0.1);
  place(at, distance < reach);
  gl_PointSize = size;
#endif
#ifdef INSIDE
  // Near its root, a vertex as deep as the root does not count as inside.
  uint root = 2u * uint(gl_InstanceID) * nodes_per_hair, at = root + 2u * uint(gl_VertexID);
  vec4 position = hair_vertices[at];
  vec3 normal;
  float distance = bodyDistance(position.xyz, normal), root_distance = bodyDistance(hair_vertices[root].xyz, normal);
  float u = position.w * hairs[hair_list[first_hair + uint(gl_InstanceID)]].extent;  // of the guide
  mark_color = vec3(1, 0.05, 0.3);
  place(position.xyz, hair_vertices[at + 1u].w >= 0.0 && distance < keptDistance(u, root_distance, 0.0) - reach);
  gl_PointSize = size;
#endif
}
