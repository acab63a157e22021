// The light of a picture at a point; Light in render/light.h. Needs scene.glsl.
const vec3 kSun = vec3(2.3, 2.17, 2.0);  // irradiance of intensity 1, across its way

bool lightHasPlace() { return scene.light_place.w > 0.5; }

vec3 towardsLight(vec3 world) {
  return lightHasPlace() ? normalize(scene.light_place.xyz - world + vec3(0, 1e-12, 0)) : scene.light.xyz;
}

// What arrives across its way where nothing is between: by the inverse-square law, and within the cone.
vec3 lightAt(vec3 world) {
  vec3 irradiance = kSun * scene.light_cone.z;
  if (!lightHasPlace()) return irradiance;
  vec3 off = scene.light_place.xyz - world;
  float d2 = max(dot(off, off), 1e-6);
  float t = clamp((dot(scene.light.xyz, off) * inversesqrt(d2) - scene.light_cone.y) / (scene.light_cone.x - scene.light_cone.y),
                  0.0, 1.0);
  return irradiance * (t * t * (3.0 - 2.0 * t) / d2);
}

// The eye of the shadow maps: their depth is linear in the distance along its axis, for a light with a place too.
vec4 lightClip(vec3 world) {
  vec4 clip = scene.light_view_projection * vec4(world, 1);
  clip.z *= clip.w;
  return clip;
}
