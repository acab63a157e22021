#version 450 core
// variants: COLOR=1 | COLOR=1 STRIP=1 | COLOR=1 PER_FRAGMENT=1 | COLOR=1 STRIP=1 PER_FRAGMENT=1 | OPACITY=1 | FRONT=1
// A vertex of grown hair: an instance per hair, a vertex per node, or two with STRIP.
#include "render/shaders/scene.glsl"
#include "render/shaders/hair_curve.glsl"
#include "render/shaders/hair_vertex.glsl"
layout(std430, binding = 5) readonly buffer HairVertices { vec4 hair_vertices[]; };
uniform uint first_hair;  // of the buffer, in the list
uniform uint nodes_per_hair;

void main() {
  uint in_buffer = uint(gl_InstanceID);
#ifdef STRIP
  uint node = uint(gl_VertexID) / 2u;
  float side = (gl_VertexID & 1) == 0 ? -1.0 : 1.0;
#else
  uint node = uint(gl_VertexID);
  float side = 0.0;
#endif
  uint at = 2u * (in_buffer * nodes_per_hair + node);
  vec4 position_along = hair_vertices[at], tangent_width = hair_vertices[at + 1u];
  uint index = first_hair + in_buffer;
  emitHair(hairs[hair_list[index]], position_along.xyz, tangent_width.xyz, position_along.w, tangent_width.w, side);
  if (tangent_width.w < 0.0) gl_Position = vec4(2, 2, 2, 1);
}
