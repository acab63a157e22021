#version 450 core
// Filters the samples around a pixel; Supersampling in render/framebuffer.h. Texture reads are linear, and the result is stored as sRGB.
layout(binding = 0) uniform sampler2D large;
layout(location = 0) out vec4 color;
uniform int factor, before, count;
uniform float weights[32];
void main() {
  ivec2 first = ivec2(gl_FragCoord.xy) * factor - before, last = textureSize(large, 0) - 1;
  vec3 sum = vec3(0);
  for (int y = 0; y < count; ++y)
    for (int x = 0; x < count; ++x)
      sum += weights[x] * weights[y] * texelFetch(large, clamp(first + ivec2(x, y), ivec2(0), last), 0).rgb;
  color = vec4(sum, 1);
}
