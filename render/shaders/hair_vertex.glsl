// What a vertex of a hair becomes in a pass, however it was grown: COLOR shades it, OPACITY and FRONT look from a light.
// Needs scene.glsl and hair_curve.glsl. STRIP: one of two on either side of the hair.
#include "render/shaders/light.glsl"
#ifdef COLOR
#include "render/shaders/color.glsl"
#include "render/shaders/shadow.glsl"
#ifdef PER_FRAGMENT
layout(location = 4) out vec4 lit_position;  // w: part of the hair's length behind it
layout(location = 5) out vec3 lit_tangent;
layout(location = 6) flat out vec2 lit_tint;  // shade and warmth
#else
#include "render/shaders/hair_shading.glsl"
layout(location = 4) out vec3 radiance;
#endif
#endif
layout(location = 2) out float coverage;
layout(location = 3) flat out vec2 dither;  // what is left of it, and Hair::first_sample
uniform float threshold;

// Fewer, wider hairs; see hair_detail.h. The factor of a hair's width, and what is left of its dither.
float detailWidth(Hair hair, out float left) {
  float chance = clamp(threshold * hair.width * hair.importance, 1e-20, 1.0);
  left = clamp((hair.dither - 1.0 + chance) / chance, 0.0, 0.99999994);
  float factor = 1.0 / chance;
#ifdef OPACITY
  // The last ones thin out, as the light's maps know no samples.
  factor *= mix(1.0, min(4.0 * left, 1.0) * (8.0 / 7.0), 1.0 - chance);
#endif
  return factor;
}

#ifndef COLOR
uniform int map_light;            // whose maps these are
uniform float line_texels = 1.0;  // across lines in the opacity map

// What a hair of width 1 covers of each texel that its line has in the light's maps: as much of the light's rays as it is
// across, shared out among the texels. A line has as many as it is across in every column, or row, that it crosses.
float lengthInTexel(vec3 position, vec3 tangent, vec4 clip) {
  mat4 m = scene.lights[map_light].view_projection;
  vec3 off = position - scene.lights[map_light].place.xyz;
  // Of length 1 along the map's axis.
  vec3 ray = lightHasPlace(map_light) ? off / max(clip.w, 1e-3) : scene.lights[map_light].way.xyz;
  vec4 along = m * vec4(tangent, 0);
  vec2 way = abs(along.xy * clip.w - clip.xy * along.w);
  float across = length(cross(tangent, ray)) * length(vec3(m[0].x, m[1].x, m[2].x));
  return scene.lights[map_light].cone.z * across / (line_texels * max(max(way.x, way.y), 1e-12));
}
#endif

void emitHair(Hair hair, vec3 position, vec3 tangent, float along, float side) {
  float width = scene.hair_color.w * hair.width * hairTaper(along) * detailWidth(hair, dither.x);
  dither.y = hair.first_sample;
#ifdef COLOR
  gl_Position = scene.view_projection * vec4(position, 1);
  float pixels = scene.eye.w / max(gl_Position.w, 1e-3);  // per metre there
  // Guides lie on the skin or a little in it: for the depth test, hair is up to 2.5 mm nearer to the eye.
  vec3 to_eye = normalize(scene.eye.xyz - position);
  vec4 nearer_clip = scene.view_projection * vec4(position + 0.0025 * scene.sampling.z * to_eye, 1);
#ifdef STRIP
  // Towards the eye, at least a pixel wide; a thinner hair covers its part of that.
  float drawn = max(width, 1.0 / pixels);
  gl_Position = scene.view_projection * vec4(position + side * 0.5 * drawn * normalizeOrZero(cross(tangent, to_eye)), 1);
  coverage = width / drawn;
#else
  coverage = width * pixels / scene.sampling.y;
#endif
  if (nearer_clip.w > 0.0) gl_Position.z = nearer_clip.z / nearer_clip.w * gl_Position.w;
#ifdef PER_FRAGMENT
  lit_position = vec4(position, along);
  lit_tangent = tangent;
  lit_tint = vec2(hair.shade, hair.warmth);
#else
  radiance = hairRadiance(position, tangent, along, hair.shade, hair.warmth);
#endif
#else
  gl_Position = lightClip(map_light, position);
  coverage = width * lengthInTexel(position, tangent, gl_Position);
#endif
}
