#version 450 core
// variants: none | LIGHTS=1 CASTERS=1 | LIGHTS=4 CASTERS=2
#include "render/shaders/scene.glsl"
#include "render/shaders/light.glsl"
layout(location = 0) in vec3 world;
layout(location = 1) in vec3 normal;
layout(location = 0) out vec4 color;

// Skin: diffuse light wrapped past the terminator, more so in red, as light spreads below the skin.
vec3 wrappedDiffuse(float cosine) {
  vec3 wrap = vec3(0.30, 0.16, 0.12);
  vec3 lit = clamp((vec3(cosine) + wrap) / (1.0 + wrap), 0.0, 1.0);
  return lit * lit * (3.0 - 2.0 * lit) * 0.35 + lit * 0.65;
}

void main() {
  vec3 n = normalize(normal), e = normalize(scene.eye.xyz - world);
  if (dot(n, e) < 0.0 && !gl_FrontFacing) n = -n;
  vec3 diffuse = vec3(0), sheen = vec3(0);
  vec2 clear = vec2(0);
  for (int light = 0; light < LIGHTS; ++light) {
    vec3 l = towardsLight(light, world), h = normalize(l + e);
    float lit = 1.0, hair = 0.0;
    if (castsShadow(light)) {
      vec3 at = lightCoordinates(light, world + 0.002 * scene.sampling.z * n);
      lit = solidVisibility(light, at, 0.003 * scene.sampling.z, 1);
      hair = hairOpticalDepth(light, at, 0.0);
      clear += clearAlong(light, exp(-0.15 * hair), lit);
    }
    vec3 direct = lightAt(light, world) * lit * exp(-hair * vec3(0.45, 0.55, 0.6));
    diffuse += wrappedDiffuse(dot(n, l)) * direct * 0.5;
    float shine = 0.09 * pow(max(dot(n, h), 0.0), 14.0) + 0.06 * pow(max(dot(n, h), 0.0), 60.0);
    sheen += direct * max(dot(n, l), 0.0) * shine;
  }
  float facing = max(dot(n, e), 0.0);
  float fresnel = 0.03 + 0.35 * pow(1.0 - facing, 5.0);
  vec3 radiance = scene.body_color.rgb * (diffuse + ambient(n) * (0.35 + 0.65 * clearAround(clear)));
  radiance += sheen + ambient(reflect(-e, n)) * fresnel;
  color = vec4(toneMapped(radiance), 1);
}
