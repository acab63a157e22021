#version 450 core
#include "render/shaders/scene.glsl"
#include "render/shaders/color.glsl"
#include "render/shaders/light.glsl"
#include "render/shaders/shadow.glsl"
layout(location = 0) in vec3 world;
layout(location = 0) out vec4 color;
void main() {
  float from_center = length(world.xz - scene.ground.xz) / scene.ground.w;
  if (from_center > 1.0 || scene.eye.y < scene.ground.y) discard;
  float lit = 1.0;
  if (scene.sampling.w > 0.0) {
    vec3 at = lightCoordinates(world);
    lit = solidVisibility(at, 0.004, 1) * exp(-0.6 * hairOpticalDepth(at, 0.0));
  }
  vec3 albedo = scene.background.rgb * 0.55;
  vec3 radiance = albedo * (ambient(vec3(0, 1, 0)) + lightAt(world) * max(towardsLight(world).y, 0.0) * lit);
  color = vec4(mix(toneMapped(radiance), backgroundColor(gl_FragCoord.xy), smoothstep(0.15, 1.0, from_center)), 1);
}
