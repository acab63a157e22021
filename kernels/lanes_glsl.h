// Lane vocabulary of GLSL 4.50: one float per invocation. real3 and quat are built-in vectors; dot, cross, length,
// sqrt, abs, min, max, clamp and the operators are built in, too.
// The guard lets texts that are included together each include it.
#ifndef LANE_FN
#define real float
#define real3 vec3
#define quat vec4
#define mask bool
#define LANE_FN
#define LANE_IN(type) in type
#define LANE_OUT(type) out type
#define LANE_INOUT(type) inout type
#define lit(value) float(value)
#define makeReal3(x, y, z) vec3(x, y, z)
#define makeQuat(x, y, z, w) vec4(x, y, z, w)

bool maskAll() { return true; }
bool maskNone() { return false; }
vec3 zero3() { return vec3(0); }
#define blend(a, b, t) mix(a, b, t)
#define fadeBetween(low, high, at) smoothstep(low, high, at)
float inverse(float a) { return 1.0 / a; }
float inverseSqrt(float a) { return inversesqrt(a); }
float madd(float a, float b, float c) { return fma(a, b, c); }
vec3 madd(vec3 a, float s, vec3 c) { return fma(a, vec3(s), c); }
// SELECT_BY_MIX gives the same values, but drivers generate other code for it; measure which is faster.
#ifdef SELECT_BY_MIX
float select(bool m, float a, float b) { return mix(b, a, m); }
vec3 select(bool m, vec3 a, vec3 b) { return mix(b, a, bvec3(m)); }
vec4 select(bool m, vec4 a, vec4 b) { return mix(b, a, bvec4(m)); }
#else
float select(bool m, float a, float b) { return m ? a : b; }
vec3 select(bool m, vec3 a, vec3 b) { return m ? a : b; }
vec4 select(bool m, vec4 a, vec4 b) { return m ? a : b; }
#endif
#endif
