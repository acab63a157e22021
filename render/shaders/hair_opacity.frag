#version 450 core
// Adds a hair's optical depth to the layer that it lies in. As in hair.frag, thin hairs are drawn as fewer darker ones.
#include "render/shaders/scene.glsl"
#include "render/shaders/shadow.glsl"
layout(location = 2) in float coverage;
layout(location = 3) flat in float dither;
layout(location = 0) out vec4 layers;
uniform vec2 texel;       // of the opacity map
uniform float steps;      // of coverage
void main() {
  float depth = behindFront(vec3(gl_FragCoord.xy * texel, gl_FragCoord.z), 0.0);
  float opacity = floor(min(coverage, 1.0) * steps + dither) / steps;
  layers = opacity * vec4(lessThanEqual(kLayerStarts, vec4(depth))) * vec4(greaterThan(kLayerEnds, vec4(depth)));
  if (depth < 0.0) layers.x = opacity;
  if (depth >= kLayerEnds.w) layers.w = opacity;
}
