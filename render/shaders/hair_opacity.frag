#version 450 core
// Adds a hair's optical depth to the layer that it lies in.
#include "render/shaders/scene.glsl"
#include "render/shaders/shadow.glsl"
layout(location = 2) in float coverage;
layout(location = 0) out vec4 layers;
void main() {
  float depth = behindFront(vec3(gl_FragCoord.xy / vec2(textureSize(hair_opacity, 0)), gl_FragCoord.z), 0.0);
  float opacity = coverage;
  layers = opacity * vec4(lessThanEqual(kLayerStarts, vec4(depth))) * vec4(greaterThan(kLayerEnds, vec4(depth)));
  if (depth < 0.0) layers.x = opacity;
  if (depth >= kLayerEnds.w) layers.w = opacity;
}
