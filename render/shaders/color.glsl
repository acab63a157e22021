// Colour and ambient light. Radiance is linear; needs scene.glsl.
const vec3 kSky = vec3(0.34, 0.38, 0.45);
const vec3 kBounce = vec3(0.15, 0.13, 0.12);

vec3 ambient(vec3 normal) { return mix(kBounce, kSky, 0.5 + 0.5 * normal.y); }

vec3 toneMapped(vec3 radiance) { return vec3(1) - exp(-radiance); }

// Background in sRGB: lighter behind the middle, darker towards the edges and below.
vec3 backgroundColor(vec2 pixel) {
  vec2 from_middle = (pixel - 0.5 * vec2(scene.body_color.w, scene.background.w)) / scene.background.w;
  float falloff = smoothstep(0.0, 1.1, length(from_middle * vec2(0.8, 1.0)));
  return scene.background.rgb * mix(0.85, 0.28, falloff) * (1.0 + 0.25 * from_middle.y);
}
