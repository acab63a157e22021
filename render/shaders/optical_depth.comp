#version 450 core
// Evaluates a light's maps at points: for LightProbe in render/shader_validation.h.
layout(local_size_x = 64) in;
#include "render/shaders/scene.glsl"
#include "render/shaders/light.glsl"
layout(std430, binding = 9) readonly buffer Points { float points[]; };  // three each: the light's coordinates, 0 to 1
layout(std430, binding = 10) writeonly buffer Answers { vec2 answers[]; };
uniform uint point_count;
uniform int light;
void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= point_count) return;
  vec3 at = vec3(points[3u * i], points[3u * i + 1u], points[3u * i + 2u]);
  answers[i] = vec2(behindFront(light, at, 1e3), hairOpticalDepth(light, at, 0.0));
}
