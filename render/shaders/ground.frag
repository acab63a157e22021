#version 450 core
// variants: none | LIGHTS=1 CASTERS=1 | LIGHTS=4 CASTERS=2
#include "render/shaders/scene.glsl"
#include "render/shaders/light.glsl"
layout(location = 0) in vec3 world;
layout(location = 0) out vec4 color;
void main() {
  float from_center = length(world.xz - scene.ground.xz) / scene.ground.w;
  if (from_center > 1.0 || scene.eye.y < scene.ground.y) discard;
  vec3 arriving = ambient(vec3(0, 1, 0));
  for (int light = 0; light < LIGHTS; ++light) {
    float lit = 1.0;
    if (castsShadow(light)) {
      vec3 at = lightCoordinates(light, world);
      lit = solidVisibility(light, at, 0.004 * scene.sampling.z, 1) * exp(-0.6 * hairOpticalDepth(light, at, 0.0));
    }
    arriving += lightAt(light, world) * max(towardsLight(light, world).y, 0.0) * lit;
  }
  vec3 albedo = scene.background.rgb * groundAlbedo();
  vec3 radiance = albedo * arriving;
  color = vec4(mix(toneMapped(radiance), backgroundColor(gl_FragCoord.xy), groundFade(from_center)), 1);
}
