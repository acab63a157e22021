#pragma once
#include <cstdint>
#include <vector>

#include "core/geometry.h"

namespace strandcast {

enum class PrimitiveKind : uint32_t { kSphere = 0, kCapsule = 1, kPlane = 2 };

/// A shape that hair collides with, in the frame of the body it belongs to.
struct ContactPrimitive {
  PrimitiveKind kind = PrimitiveKind::kSphere;
  Vec3 a = Vec3::Zero();   ///< sphere: centre; capsule: one end; plane: a point on it. Metres.
  Vec3 b = Vec3::UnitY();  ///< capsule: the other end; plane: unit normal; sphere: unused
  float radius = 0;        ///< sphere and capsule, metres
  float friction = 0.3f;   ///< Coulomb coefficient, 0 or more
};

/// The same shape in the world over one step, as every backend reads it: five 4-vectors, 80 bytes, one layout
/// for the CPU arrays and for GLSL std430. Positions are interpolated linearly through the step.
struct alignas(16) MovingPrimitive {
  float a_begin[3];
  float radius;
  float a_end[3];
  uint32_t kind;  ///< PrimitiveKind
  float b_begin[3];
  float friction;
  float b_end[3];
  float unused0;
  float
      angular_velocity[3];  ///< rad/s, about a: the surface at p moves with v_a + angular_velocity x (p - a)
  float unused1;
};
static_assert(sizeof(MovingPrimitive) == 80);

/// Places `primitive` in the world between the poses of its body at the start and the end of a step of `dt`
/// seconds.
MovingPrimitive moved(const ContactPrimitive& primitive, const Pose& begin, const Pose& end, float dt);

/// Distance from `point` to the surface at the end of the step, metres; negative inside.
float signedDistance(const MovingPrimitive& primitive, const Vec3& point);

}  // namespace strandcast
