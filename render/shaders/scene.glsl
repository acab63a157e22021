// What every shader knows of a picture; SceneBlock in render/scene_block.h, field for field.
layout(std140, binding = 0) uniform Scene {
  mat4 view_projection;
  mat4 light_view_projection;
  vec4 eye;
  vec4 light;
  vec4 light_place;
  vec4 light_cone;
  vec4 hair_color;
  vec4 body_color;
  vec4 background;
  vec4 ground;
  vec4 sampling;
  vec4 layer_ends[4];
  vec4 layer_limits[4];
  vec4 opacity;
} scene;
