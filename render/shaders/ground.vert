#version 450 core
// A square around the disc.
#include "render/shaders/scene.glsl"
layout(location = 0) out vec3 world;
void main() {
  vec2 corner = vec2((gl_VertexID & 1) == 0 ? -1.0 : 1.0, (gl_VertexID & 2) == 0 ? -1.0 : 1.0);
  world = scene.ground.xyz + scene.ground.w * vec3(corner.x, 0, corner.y);
  gl_Position = scene.view_projection * vec4(world, 1);
}
