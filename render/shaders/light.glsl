// The lights of a picture at a point; Light in render/light.h. Needs scene.glsl.
const vec3 kSun = vec3(2.3, 2.17, 2.0);  // irradiance of intensity 1 and white, across its way

// How many there are, and how many of them, the first ones, cast shadows: LightCounts.
#ifndef LIGHTS
#define LIGHTS 0
#define CASTERS 0
#endif
bool castsShadow(int light) { return light < CASTERS; }
bool lightHasPlace(int light) { return scene.lights[light].place.w > 0.5; }

vec3 towardsLight(int light, vec3 world) {
  return lightHasPlace(light) ? normalize(scene.lights[light].place.xyz - world + vec3(0, 1e-12, 0)) : scene.lights[light].way.xyz;
}

// What arrives across its way where nothing is between: by the inverse-square law, and within the cone.
vec3 lightAt(int light, vec3 world) {
  vec3 irradiance = kSun * scene.lights[light].power.rgb;
  if (!lightHasPlace(light)) return irradiance;
  vec3 off = scene.lights[light].place.xyz - world;
  float d2 = max(dot(off, off), 1e-6);
  vec2 cone = scene.lights[light].cone.xy;
  float t = clamp((dot(scene.lights[light].way.xyz, off) * inversesqrt(d2) - cone.y) / (cone.x - cone.y), 0.0, 1.0);
  return irradiance * (t * t * (3.0 - 2.0 * t) / d2);
}

// The eye of its shadow maps: their depth is linear in the distance along its axis, for a light with a place too.
vec4 lightClip(int light, vec3 world) {
  vec4 clip = scene.lights[light].view_projection * vec4(world, 1);
  clip.z *= clip.w;
  return clip;
}

// Of light from all around: the mean of what each light that casts shadows finds of it, by their power. clearAlong() is to be
// added up; 1 without any. What hair there is before a solid says nothing of what is behind it: `past_solids` 0.
vec2 clearAlong(int light, float through_hair, float past_solids) {
  return dot(scene.lights[light].power.rgb, vec3(1)) * vec2(mix(1.0, through_hair, past_solids), 1);
}
float clearAround(vec2 sum) { return sum.y > 0.0 ? sum.x / sum.y : 1.0; }
