#version 450 core
// variants: none | DEPTH_ONLY=1
#include "render/shaders/scene.glsl"
#include "render/shaders/light.glsl"
layout(location = 0) in vec3 rest_position;
layout(location = 1) in vec3 rest_normal;
layout(location = 2) in float head_weight;
uniform mat4 head;
#ifdef DEPTH_ONLY
uniform int map_light;
layout(location = 0) out float depth;  // see lightClip()
#else
layout(location = 0) out vec3 world;
layout(location = 1) out vec3 normal;
#endif
void main() {
  vec3 moved = mix(rest_position, (head * vec4(rest_position, 1)).xyz, head_weight);
#ifdef DEPTH_ONLY
  // The depth is interpolated as a varying. The rasterizer's depth is linear in screen space, which for a light with a
  // position overestimates the distance between the corners of a large triangle.
  vec4 clip = scene.lights[map_light].view_projection * vec4(moved, 1);
  depth = 0.5 * clip.z + 0.5;
  gl_Position = vec4(clip.xy, 0, clip.w);
#else
  world = moved;
  normal = mix(rest_normal, mat3(head) * rest_normal, head_weight);
  gl_Position = scene.view_projection * vec4(moved, 1);
#endif
}
