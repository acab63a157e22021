// Parameters of a picture in every shader; LightBlock and SceneBlock in render/scene_block.h, field for field.
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
