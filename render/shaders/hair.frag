#version 450 core
// variants: none | PER_FRAGMENT=1 | PER_FRAGMENT=1 LIGHTS=4 CASTERS=2
// A hair narrower than its line covers only a fraction of each pixel's samples, the same along the whole hair. This is
// stochastic transparency (Enderton et al. 2010) with noise that runs along strands, where it looks like strands. With
// alpha to coverage the device chooses the samples.
#include "render/shaders/scene.glsl"
#ifdef PER_FRAGMENT
#include "render/shaders/light.glsl"
#include "render/shaders/hair_shading.glsl"
layout(location = 4) in vec4 lit_position;
layout(location = 5) in vec3 lit_tangent;
layout(location = 6) flat in vec2 lit_tint;
layout(location = 7) flat in vec3 lit_color;
#else
layout(location = 4) in vec3 radiance;
#endif
layout(location = 2) in float coverage;
layout(location = 3) flat in vec2 dither;
layout(location = 0) out vec4 color;
void main() {
  int samples = int(scene.sampling.x);
  int reached = int(floor(min(coverage, 1.0) * scene.sampling.x + dither.x));
  if (reached <= 0) discard;
#ifdef PER_FRAGMENT
  vec3 radiance = hairRadiance(lit_color, lit_position.xyz, normalize(lit_tangent), lit_position.w, lit_tint.x, lit_tint.y);
#endif
  gl_SampleMask[0] = -1;  // all samples; undefined if not written
  if (scene.opacity.z > 0.0) {
    color = vec4(toneMapped(radiance), float(reached) / scene.sampling.x);
    return;
  }
  if (samples > 1) {
    int first = int(dither.y * scene.sampling.x);
    int run = (1 << min(reached, samples)) - 1;
    gl_SampleMask[0] = (run << first) | (run >> (samples - first));
  }
  color = vec4(toneMapped(radiance), 1);
}
