// The outputs of a hair's vertex in a pass, for both growth paths. COLOR shades it, OPACITY and FRONT view it from a
// light. STRIP: `side` selects one of two vertices on either side of the hair. Needs scene.glsl and hair_curve.glsl.
#include "render/shaders/light.glsl"
#ifdef COLOR
#ifdef PER_FRAGMENT
layout(location = 4) out vec4 lit_position;  // w: fraction of the hair's length up to it
layout(location = 5) out vec3 lit_tangent;
layout(location = 6) flat out vec2 lit_tint;  // shade and warmth
layout(location = 7) flat out vec3 lit_color;
#else
#include "render/shaders/hair_shading.glsl"
layout(location = 4) out vec3 radiance;
#endif
#endif
layout(location = 2) out float coverage;
layout(location = 3) flat out vec2 dither;  // remaining dither of detailWidth(), and Hair::first_sample
uniform float threshold;

// Level of detail, see hair_selection.h. Returns the factor of the hair's width; `left` is the remaining dither.
float detailWidth(Hair hair, out float left) {
  float chance = clamp(threshold * hair.width * hair.importance, 1e-20, 1.0);
  left = clamp((hair.dither - 1.0 + chance) / chance, 0.0, 0.99999994);
  float factor = 1.0 / chance;
#ifdef OPACITY
  // Hairs near dropping out become narrower, because the light's maps have no samples. 8/7 keeps the mean width.
  factor *= mix(1.0, min(4.0 * left, 1.0) * (8.0 / 7.0), 1.0 - chance);
#endif
  return factor;
}

#ifndef COLOR
uniform int map_light;            // index of the light
uniform float line_texels = 1.0;  // line width in the opacity map, texels

// Coverage per texel of a line for a hair of width 1 in the light's maps: the hair's cross section perpendicular to the
// light's rays, divided among the line's texels. A line has line_texels texels in every column (or row) that it
// crosses.
float lengthInTexel(vec3 position, vec3 tangent, vec4 clip) {
  mat4 m = scene.lights[map_light].view_projection;
  vec3 off = position - scene.lights[map_light].place.xyz;
  // Normalised to length 1 along the map's axis.
  vec3 ray = lightHasPlace(map_light) ? off / max(clip.w, 1e-3) : scene.lights[map_light].way.xyz;
  vec4 along = m * vec4(tangent, 0);
  vec2 way = abs(along.xy * clip.w - clip.xy * along.w);
  float across = length(cross(tangent, ray)) * length(vec3(m[0].x, m[1].x, m[2].x));
  return scene.lights[map_light].cone.z * across / (line_texels * max(max(way.x, way.y), 1e-12));
}
#endif

// Linear; Hair::color, else that of the settings.
vec3 colorOfHair(Hair hair) {
  if (hair.color == 0u) return scene.hair_color.rgb;
  vec3 s = unpackUnorm4x8(hair.color).rgb;
  return mix(s / 12.92, pow((s + 0.055) / 1.055, vec3(2.4)), greaterThan(s, vec3(0.04045)));
}

// `part`: width at this vertex over the hair's full width.
void emitHair(Hair hair, vec3 position, vec3 tangent, float along, float part, float side) {
  float width = scene.hair_color.w * hair.width * part * detailWidth(hair, dither.x);
  dither.y = hair.first_sample;
#ifdef COLOR
  gl_Position = scene.view_projection * vec4(position, 1);
  float pixels = scene.eye.w / max(gl_Position.w, 1e-3);  // per metre at this depth
  // Guides lie on the skin or slightly inside: the depth test moves hair up to 2.5 mm towards the eye.
  vec3 to_eye = normalize(scene.eye.xyz - position);
  vec4 nearer_clip = scene.view_projection * vec4(position + 0.0025 * scene.sampling.z * to_eye, 1);
#ifdef STRIP
  // A strip that faces the eye, at least one pixel wide; a narrower hair covers a fraction of it.
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
  lit_color = colorOfHair(hair);
#else
  radiance = hairRadiance(colorOfHair(hair), position, tangent, along, hair.shade, hair.warmth);
#endif
#else
  gl_Position = lightClip(map_light, position);
  coverage = width * lengthInTexel(position, tangent, gl_Position);
#endif
}
