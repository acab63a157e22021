// The lights of a picture at a point (Light in light/light_sources.h), and the transmittance from a light to a point:
// solids by a depth map, hair by opacity layers behind its front (deep opacity maps, Yuksel and Keyser 2008). Needs
// scene.glsl.

// LightCounts: numbers of lights, and of those that cast shadows, which come first.
#ifndef LIGHTS
#define LIGHTS 0
#define CASTERS 0
#endif
bool castsShadow(int light) { return light < CASTERS; }
bool lightHasPlace(int light) { return scene.lights[light].place.w > 0.5; }

vec3 towardsLight(int light, vec3 world) {
  return lightHasPlace(light) ? normalize(scene.lights[light].place.xyz - world + vec3(0, 1e-12, 0))
                              : scene.lights[light].way.xyz;
}

// Irradiance perpendicular to the light's direction, unshadowed: inverse-square law and spot cone.
vec3 lightAt(int light, vec3 world) {
  vec3 irradiance = sunIrradiance() * scene.lights[light].power.rgb;
  if (!lightHasPlace(light)) return irradiance;
  vec3 off = scene.lights[light].place.xyz - world;
  float d2 = max(dot(off, off), 1e-6);
  vec2 cone = scene.lights[light].cone.xy;
  float t = clamp((dot(scene.lights[light].way.xyz, off) * inversesqrt(d2) - cone.y) / (cone.x - cone.y), 0.0, 1.0);
  return irradiance * (t * t * (3.0 - 2.0 * t) / d2);
}

// Clip coordinates in the light's shadow maps. Depth is linear in the distance along the light's axis, also for a light
// with a position.
vec4 lightClip(int light, vec3 world) {
  vec4 clip = scene.lights[light].view_projection * vec4(world, 1);
  clip.z *= clip.w;
  return clip;
}

// Ambient visibility: the mean of `through_hair`, the transmittance towards each shadow-casting light, weighted by the
// lights' power. Sum clearAlong() over the lights and pass the sum to clearAround(), which is 1 without such lights.
// `past_solids` 0 where a solid blocks the light, because hair in front of the solid says nothing about the point
// behind it.
vec2 clearAlong(int light, float through_hair, float past_solids) {
  return dot(scene.lights[light].power.rgb, vec3(1)) * vec2(mix(1.0, through_hair, past_solids), 1);
}
float clearAround(vec2 sum) { return sum.y > 0.0 ? sum.x / sum.y : 1.0; }

// Arrays have one layer (hair_opacity: one run of slices) per light:
layout(binding = 0) uniform sampler2DArrayShadow solid_depth;
layout(binding = 1) uniform sampler2DArray hair_front;    // depth of the hair nearest to the light, coarse for smoothness
layout(binding = 2) uniform sampler2DArray hair_opacity;  // optical depth from the front to the end of each layer

// Coordinates 0 to 1 in the maps; (-1, -1, -1), outside the maps and so lit, for points behind the light.
vec3 lightCoordinates(int light, vec3 world) {
  vec4 clip = scene.lights[light].view_projection * vec4(world, 1);
  return clip.w > 0.0 ? vec3(0.5 * clip.xy / clip.w, 0.5 * clip.z) + 0.5 : vec3(-1);
}

// 1 inside the maps, falling to 0 towards their edge where the maps do not cover all that the light reaches.
float withinMaps(int light, vec3 light_coordinates) {
  float fade = scene.lights[light].cone.w;
  if (fade <= 0.0) return 1.0;
  vec2 off = abs(2.0 * light_coordinates.xy - 1.0);
  return 1.0 - smoothstep(1.0 - fade, 1.0, max(off.x, off.y));
}

// Metres behind the front of the hair, `without` where there is no front. Bilinear over the texels that contain hair,
// so that the front extends smoothly past its outline.
float behindFront(int light, vec3 light_coordinates, float without) {
  vec4 front = textureGather(hair_front, vec3(light_coordinates.xy, light));
  vec2 f = fract(light_coordinates.xy * vec2(textureSize(hair_front, 0).xy) - 0.5);
  vec4 weights = vec4((1.0 - f.x) * f.y, f.x * f.y, f.x * (1.0 - f.y), (1.0 - f.x) * (1.0 - f.y));
  weights = (weights + 1e-4) * vec4(lessThan(front, vec4(1)));
  float sum = dot(weights, vec4(1));
  return sum > 0.0 ? (light_coordinates.z - dot(weights, front) / sum) * scene.lights[light].way.w : without;
}

// Optical depth up to `depth` metres behind the front: linear between the ends of layers.
float depthInLayers(int light, vec2 texel, float depth) {
  float sum = 0.0, start = 0.0, before = 0.0;
  int slices = int(scene.opacity.x);
  for (int slice = 0; slice < slices; ++slice) {
    vec4 ends = scene.lights[light].layer_ends[slice], starts = vec4(start, ends.xyz);
    vec4 up_to = textureLod(hair_opacity, vec3(texel, light * slices + slice), 0.0);
    sum += dot(clamp((vec4(depth) - starts) / (ends - starts), 0.0, 1.0), up_to - vec4(before, up_to.xyz));
    start = ends.w;
    before = up_to.w;
  }
  return sum;
}

// Optical depth of the hair between the light and the point, without the last `margin` metres before the point.
float hairOpticalDepth(int light, vec3 light_coordinates, float margin) {
  float depth = behindFront(light, light_coordinates, 1e3) - margin;
  int radius = int(scene.opacity.y);
  vec2 texel = 1.0 / vec2(textureSize(hair_opacity, 0).xy);
  float sum = 0.0;
  for (int y = -radius; y <= radius; ++y)
    for (int x = -radius; x <= radius; ++x) sum += depthInLayers(light, light_coordinates.xy + texel * vec2(x, y), depth);
  return withinMaps(light, light_coordinates) * sum / float((2 * radius + 1) * (2 * radius + 1));
}

// 1 in the light, 0 in the shadow of the body. Filtered over (2 radius + 1)^2 bilinear taps.
float solidVisibility(int light, vec3 light_coordinates, float bias_meters, int radius) {
  vec2 texel = 1.5 / vec2(textureSize(solid_depth, 0).xy);
  // Points beyond the map's far plane are still behind everything in the map.
  float reference = min(light_coordinates.z - bias_meters / scene.lights[light].way.w, 1.0);
  float sum = 0.0;
  for (int y = -radius; y <= radius; ++y)
    for (int x = -radius; x <= radius; ++x)
      sum += texture(solid_depth, vec4(light_coordinates.xy + texel * vec2(x, y), light, reference));
  return mix(1.0, sum / float((2 * radius + 1) * (2 * radius + 1)), withinMaps(light, light_coordinates));
}
