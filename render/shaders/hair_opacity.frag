#version 450 core
// Adds a hair's optical depth to the layer that contains it and to all layers behind; see OpacityLayers in render/render_settings.h.
#include "render/shaders/scene.glsl"
#include "render/shaders/light.glsl"
layout(location = 2) in float coverage;
layout(location = 0) out vec4 layers[4];
uniform float map_size;
uniform int map_light;
void main() {
  float depth = behindFront(map_light, vec3(gl_FragCoord.xy / map_size, gl_FragCoord.z), 0.0);
  for (int slice = 0; slice < 4; ++slice)
    layers[slice] = coverage * vec4(lessThan(vec4(depth), scene.lights[map_light].layer_limits[slice]));
}
