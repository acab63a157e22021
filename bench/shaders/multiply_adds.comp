#version 450
// Only independent chains of fused multiply-adds, to measure the GPU's peak arithmetic rate. A round has 64 per
// invocation: kMultiplyAdds of bench/gpu_limits.cc.
layout(local_size_x = 256) in;
layout(std430, binding = 0) writeonly buffer Sums { float sums[]; };
layout(location = 0) uniform int rounds;
layout(location = 1) uniform vec2 by_and_plus;  // uniforms, so that the compiler cannot fold them

void main() {
  const vec4 by = vec4(by_and_plus.x), plus = vec4(by_and_plus.y);
  // Each chain has its own initial value, or compilers merge them.
  vec4 a = vec4(0.1, 0.2, 0.3, 0.4) * float(gl_LocalInvocationIndex), b = a + 0.5, c = a + 0.6, d = a + 0.7;
  for (int round = 0; round < rounds; ++round) {
    a = fma(a, by, plus), b = fma(b, by, plus), c = fma(c, by, plus), d = fma(d, by, plus);
    a = fma(a, by, plus), b = fma(b, by, plus), c = fma(c, by, plus), d = fma(d, by, plus);
    a = fma(a, by, plus), b = fma(b, by, plus), c = fma(c, by, plus), d = fma(d, by, plus);
    a = fma(a, by, plus), b = fma(b, by, plus), c = fma(c, by, plus), d = fma(d, by, plus);
  }
  sums[gl_GlobalInvocationID.x] = dot(a + b + c + d, vec4(1.0));
}
