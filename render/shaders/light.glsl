// The lights of a picture at a point; Light in render/light.h. Needs scene.glsl.
const vec3 kSun = vec3(2.3, 2.17, 2.0);  // irradiance of a white light of intensity 1, perpendicular to its direction

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
  vec3 irradiance = kSun * scene.lights[light].power.rgb;
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
