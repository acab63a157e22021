#version 450 core
// variants: COLOR=1 | COLOR=1 PER_FRAGMENT=1 | OPACITY=1 | FRONT=1 | CAPTURE=1
// Grows one vertex of one hair. CAPTURE: transform feedback for tests.
layout(isolines, equal_spacing) in;
#define BODIES
#include "render/shaders/scene.glsl"
#define HAIR_BODIES_ACCESS readonly
#include "render/shaders/hair_curve.glsl"
#include "render/shaders/hair_vertex.glsl"
#ifdef CAPTURE
layout(xfb_buffer = 0, xfb_stride = 32) out;
layout(location = 0, xfb_offset = 0) out vec4 captured_position;  // w: hair
layout(location = 1, xfb_offset = 16) out vec4 captured_tangent;  // w: node
#endif
layout(location = 1) patch in uint first_hair;
layout(location = 2) patch in uint first_segment;
uniform uint node_stride;

void main() {
  uint in_patch = uint(gl_TessCoord.y * gl_TessLevelOuter[0] + 0.5);
  uint index = first_hair + in_patch;
  uint segment = first_segment + uint(gl_TessCoord.x * gl_TessLevelOuter[1] + 0.5);
  uint node = min(segment * node_stride, growth.segments);
  Hair hair = hairs[hair_list[index]];
  HairPoint point = grownHair(index, hair, node);
  vec3 tangent = normalize(point.derivative + vec3(0, 1e-12, 0));
  emitHair(hair, point.position, tangent, point.along, hairTaper(point.along), 0.0);
#ifdef CAPTURE
  captured_position = vec4(point.position, float(hair_list[index]));
  captured_tangent = vec4(tangent, float(node));
#endif
  // All vertices of a hair with an unusable guide go to one point outside the picture, so that its lines are
  // degenerate.
  if (!point.usable) gl_Position = vec4(2, 2, 2, 1);
}
