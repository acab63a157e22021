// real3 and quat over any lane type `real`, the C++ side of what GLSL has built in. Included inside a namespace.
// Plain aggregates without constructors: g++ does not inline user-written ones across Highway's target pragmas.
struct real3 {
  real x, y, z;
};
struct quat {
  real x, y, z, w;
};

#include "kernels/lanes_macros.inl"

LANE_FN real3 makeReal3(real x, real y, real z) { return real3{x, y, z}; }
LANE_FN quat makeQuat(real x, real y, real z, real w) { return quat{x, y, z, w}; }

LANE_FN real3 zero3() { return {lit(0), lit(0), lit(0)}; }

LANE_FN real3 operator+(const real3& a, const real3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
LANE_FN real3 operator-(const real3& a, const real3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
LANE_FN real3 operator-(const real3& a) { return {-a.x, -a.y, -a.z}; }
LANE_FN real3 operator*(const real3& a, real s) { return {a.x * s, a.y * s, a.z * s}; }
LANE_FN real3 select(mask m, const real3& a, const real3& b) {
  return {select(m, a.x, b.x), select(m, a.y, b.y), select(m, a.z, b.z)};
}
LANE_FN real3 madd(const real3& a, real s, const real3& c) { return {madd(a.x, s, c.x), madd(a.y, s, c.y), madd(a.z, s, c.z)}; }
LANE_FN real dot(const real3& a, const real3& b) { return madd(a.x, b.x, madd(a.y, b.y, a.z * b.z)); }
LANE_FN real3 cross(const real3& a, const real3& b) {
  return {madd(a.y, b.z, lit(0) - a.z * b.y), madd(a.z, b.x, lit(0) - a.x * b.z), madd(a.x, b.y, lit(0) - a.y * b.x)};
}
LANE_FN real length(const real3& a) { return sqrt(dot(a, a)); }
LANE_FN real clamp(real a, real low, real high) { return min(max(a, low), high); }
