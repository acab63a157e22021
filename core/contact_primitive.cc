#include "core/contact_primitive.h"

#include <cmath>

#include "kernels/scalar_float.h"

namespace strandcast {
namespace {

void put(float (&out)[3], const Vec3& v) {
  for (int c = 0; c < 3; ++c) out[c] = v[c];
}
kernels::f32::real3 take(const float (&v)[3]) { return {v[0], v[1], v[2]}; }

}  // namespace

MovingPrimitive moved(const ContactPrimitive& primitive, const Pose& begin, const Pose& end, float dt) {
  MovingPrimitive out{};
  out.kind = static_cast<uint32_t>(primitive.kind);
  out.radius = primitive.radius;
  out.friction = primitive.friction;
  put(out.a_begin, begin.apply(primitive.a));
  put(out.a_end, end.apply(primitive.a));
  const bool direction = primitive.kind == PrimitiveKind::kPlane;
  put(out.b_begin, direction ? begin.rotate(primitive.b) : begin.apply(primitive.b));
  put(out.b_end, direction ? end.rotate(primitive.b) : end.apply(primitive.b));
  const Eigen::AngleAxisf turn(Eigen::Quaternionf(end.rotation * begin.rotation.conjugate()));
  put(out.angular_velocity, turn.axis() * (turn.angle() / dt));
  return out;
}

float signedDistance(const MovingPrimitive& primitive, const Vec3& point) {
  using namespace kernels::f32;
  const real3 p{point.x(), point.y(), point.z()};
  real3 normal;
  real along;
  switch (static_cast<PrimitiveKind>(primitive.kind)) {
    case PrimitiveKind::kSphere:
      return sphereDistance(p, take(primitive.a_end), primitive.radius, normal);
    case PrimitiveKind::kCapsule:
      return capsuleDistance(p, take(primitive.a_end), take(primitive.b_end), primitive.radius, normal,
                             along);
    case PrimitiveKind::kPlane:
      break;
  }
  return planeDistance(p, take(primitive.a_end), take(primitive.b_end), normal);
}

}  // namespace strandcast
