#version 450 core
// variants: COLOR=1 | OPACITY=1 | FRONT=1 | CAPTURE=1
// Grows one vertex of one hair. COLOR shades it; OPACITY and FRONT look from the light; CAPTURE is for tests.
layout(isolines, equal_spacing) in;
#include "render/shaders/scene.glsl"
#include "render/shaders/hair_curve.glsl"
#ifdef COLOR
#include "render/shaders/color.glsl"
#include "render/shaders/shadow.glsl"
#include "render/shaders/hair_shading.glsl"
layout(location = 4) out vec3 radiance;
#endif
#ifdef CAPTURE
layout(xfb_buffer = 0, xfb_stride = 32) out;
layout(location = 0, xfb_offset = 0) out vec4 captured_position;    // w: hair
layout(location = 1, xfb_offset = 16) out vec4 captured_tangent;    // w: node
#endif
layout(location = 2) out float coverage;
layout(location = 3) flat out float dither;
layout(location = 1) patch in uint first_hair;
uniform uint pass_segments;
uniform uint node_stride;

void main() {
  uint in_patch = uint(gl_TessCoord.y * gl_TessLevelOuter[0] + 0.5);
  uint index = first_hair + in_patch;
  uint node = min(uint(gl_TessCoord.x * float(pass_segments) + 0.5) * node_stride, segments);
  Hair hair = hairs[index];
  HairPoint point = evaluateHair(hair, node);
  vec3 tangent = normalize(point.derivative + vec3(0, 1e-12, 0));
  dither = hair.dither;
#if defined(COLOR)
  gl_Position = scene.view_projection * vec4(point.position, 1);
  // Guides lie on the skin or a little in it: for the depth test, hair is 2.5 mm nearer to the eye.
  vec3 nearer = point.position + 0.0025 * normalize(scene.eye.xyz - point.position);
  vec4 nearer_clip = scene.view_projection * vec4(nearer, 1);
  if (nearer_clip.w > 0.0) gl_Position.z = nearer_clip.z / nearer_clip.w * gl_Position.w;
  coverage = scene.hair_color.w * point.width * scene.eye.w / (max(gl_Position.w, 1e-3) * scene.sampling.y);
  radiance = hairRadiance(point.position, tangent, point.u / hair.extent, hair.shade, hair.warmth);
#else
  gl_Position = scene.light_view_projection * vec4(point.position, 1);
  coverage = scene.hair_color.w * point.width * scene.sampling.z;
#endif
#ifdef CAPTURE
  captured_position = vec4(point.position, float(index));
  captured_tangent = vec4(tangent, float(node));
#endif
  // Every vertex of a hair with a broken guide goes to the same place outside the picture: lines of no length.
  if (!point.usable) gl_Position = vec4(2, 2, 2, 1);
}
