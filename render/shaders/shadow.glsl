// How much light reaches a point: solids by a depth map, hair by opacity layers behind its front (deep opacity maps,
// Yuksel and Keyser 2008). Needs scene.glsl.
layout(binding = 0) uniform sampler2DShadow solid_depth;
layout(binding = 1) uniform sampler2D hair_front;    // depth of the hair nearest to the light, coarse so that it is smooth
layout(binding = 2) uniform sampler2D hair_opacity;  // optical depth per layer

vec3 lightCoordinates(vec3 world) {
  return 0.5 * (scene.light_view_projection * vec4(world, 1)).xyz + 0.5;
}

// Where the layers start and end, metres behind the front of the hair.
const vec4 kLayerEnds = vec4(0.006, 0.018, 0.045, 0.12);
const vec4 kLayerStarts = vec4(0.0, 0.006, 0.018, 0.045);

// Metres behind the front of the hair, `without` where there is no front. Bilinear over the texels that hair reaches, so
// that the front goes on smoothly past its outline.
float behindFront(vec3 light_coordinates, float without) {
  vec4 front = textureGather(hair_front, light_coordinates.xy);
  vec2 f = fract(light_coordinates.xy * vec2(textureSize(hair_front, 0)) - 0.5);
  vec4 weights = vec4((1.0 - f.x) * f.y, f.x * f.y, f.x * (1.0 - f.y), (1.0 - f.x) * (1.0 - f.y));
  weights = (weights + 1e-4) * vec4(lessThan(front, vec4(1)));
  float sum = dot(weights, vec4(1));
  return sum > 0.0 ? (light_coordinates.z - dot(weights, front) / sum) * scene.light.w : without;
}

// Optical depth of the hair between the light and the point; `margin` metres before the point do not count.
float hairOpticalDepth(vec3 light_coordinates, float margin) {
  float depth = behindFront(light_coordinates, 1.0) - margin;
  vec4 part = clamp((vec4(depth) - kLayerStarts) / (kLayerEnds - kLayerStarts), 0.0, 1.0);
  return dot(part, textureLod(hair_opacity, light_coordinates.xy, 0.0));
}

// 1 in the light, 0 in the shadow of the body. Filtered over (2 radius + 1)^2 bilinear taps.
float solidVisibility(vec3 light_coordinates, float bias_meters, int radius) {
  vec2 texel = 1.5 / vec2(textureSize(solid_depth, 0));
  // Beyond the far end of the map everything is still behind what the map shows.
  float reference = min(light_coordinates.z - bias_meters / scene.light.w, 1.0);
  float sum = 0.0;
  for (int y = -radius; y <= radius; ++y)
    for (int x = -radius; x <= radius; ++x)
      sum += textureLod(solid_depth, vec3(light_coordinates.xy + texel * vec2(x, y), reference), 0.0);
  return sum / float((2 * radius + 1) * (2 * radius + 1));
}
