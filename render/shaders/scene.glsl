// Parameters of a picture in every shader (LightBlock and SceneBlock in render/scene_block.h, field for field), its
// background, ambient light and tone mapping (kernels/picture.h). Radiance is linear.
#include "kernels/lanes_glsl.h"
#include "kernels/picture.h"

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
  vec4 exposure;
  LightBlock lights[4];
}
scene;

vec3 ambient(vec3 normal) { return mix(skyBelow(), skyAbove(), skyBlend(normal.y)); }

vec3 toneMapped(vec3 radiance) { return toneMappedBy(scene.exposure.rgb, radiance); }

// Background, a display value.
vec3 backgroundColor(vec2 pixel) {
  vec2 from_middle = (pixel - 0.5 * vec2(scene.body_color.w, scene.background.w)) / scene.background.w;
  return backdropColor(scene.background.rgb, from_middle.x, from_middle.y);
}
