// Parameters of a picture in every shader (LightBlock and SceneBlock in render/scene_block.h, field for field), its
// background, ambient light and tone mapping. Radiance is linear.

struct LightBlock {
  mat4 view_projection;
  vec4 way;
  vec4 place;
  vec4 cone;
  vec4 power;
  vec4 layer_ends[4];
  vec4 layer_limits[4];
};
layout(std140, binding = 0) uniform Scene {
  mat4 view_projection;
  vec4 eye;
  vec4 hair_color;
  vec4 body_color;
  vec4 background;
  vec4 ground;
  vec4 sampling;
  vec4 opacity;
  LightBlock lights[4];
}
scene;

const vec3 kSky = vec3(0.34, 0.38, 0.45);
const vec3 kBounce = vec3(0.15, 0.13, 0.12);

vec3 ambient(vec3 normal) { return mix(kBounce, kSky, 0.5 + 0.5 * normal.y); }

vec3 toneMapped(vec3 radiance) { return vec3(1) - exp(-radiance); }

// Background in sRGB: lighter behind the middle, darker towards the edges and below.
vec3 backgroundColor(vec2 pixel) {
  vec2 from_middle = (pixel - 0.5 * vec2(scene.body_color.w, scene.background.w)) / scene.background.w;
  float falloff = smoothstep(0.0, 1.1, length(from_middle * vec2(0.8, 1.0)));
  return scene.background.rgb * mix(0.85, 0.28, falloff) * (1.0 + 0.25 * from_middle.y);
}
