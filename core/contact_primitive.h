#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/convex_body.h"
#include "core/distance_field.h"
#include "core/geometry.h"
#include "core/surface_bend.h"

namespace strandcast {

enum class PrimitiveKind : uint32_t {
  kSphere = 0,
  kCapsule = 1,
  kPlane = 2,
  kTaperedCapsule = 3,
  kEllipsoid = 4,
  kBox = 5,
  kConvex = 6,
  kField = 7
};

/// A shape that hair collides with, in the frame of the body it belongs to.
struct ContactPrimitive {
  PrimitiveKind kind = PrimitiveKind::kSphere;
  Vec3 a = Vec3::Zero();  ///< sphere, ellipsoid, box: centre; capsules: one end; plane: a point on it; convex
                          ///< and field: where the origin of its own frame is. Metres.
  Vec3 b = Vec3::UnitY();      ///< capsules: the other end; plane: unit normal; else unused
  float radius = 0;            ///< sphere and capsules (tapered: at a), metres
  float friction = 0.3f;       ///< Coulomb coefficient, 0 or more
  float radius_b = 0;          ///< tapered capsule: at b, metres
  Vec3 extent = Vec3::Zero();  ///< ellipsoid: half axes, of a ratio of at most 100; box: half edges. Metres.
  Quat rotation = Quat::Identity();              ///< from its own axes; ellipsoid, box, convex and field
  std::shared_ptr<const ConvexBody> convex{};    ///< of a convex one
  std::shared_ptr<const DistanceField> field{};  ///< of a field
};

/// Throws Error, naming `where`, when a number is not finite or out of range, or what its kind needs is
/// missing.
void checkPrimitive(const ContactPrimitive& primitive, const std::string& where);

/// The same shape in the world over one step, as every backend reads it: eight 4-vectors, 128 bytes, one
/// layout for the CPU arrays and for GLSL std430. Positions are interpolated linearly through the step,
/// rotations as interpolateRotation does. Kinds with a rotation turn about a, which is the middle of them.
struct alignas(16) MovingPrimitive {
  float a_begin[3];
  float radius;  ///< of kinds with a rotation: of a ball about a that holds them, however they are bent
  float a_end[3];
  uint32_t kind;  ///< PrimitiveKind
  float b_begin[3];
  float friction;
  float b_end[3];
  float radius_b;
  float
      angular_velocity[3];  ///< rad/s, about a: the surface at p moves with v_a + angular_velocity x (p - a)
  uint32_t data;            ///< convex and field: first word in ShapeData::words
  float rotation_begin[4];  ///< x y z w
  float rotation_end[4];
  float extent[3];
  uint32_t extra;  ///< convex: how many planes; field: first word of its MovingBend, 0 = it is as at rest
};
static_assert(sizeof(MovingPrimitive) == 128);

/// What convex bodies and fields consist of, as every backend reads it: flat words of 32 bits. A convex body
/// is the unit normal and distance of each plane as floats; a field its FieldGrid, index, samples and
/// corners. Both are moved so that their middle is at their origin. And the bends of fields, which change
/// from step to step.
struct ShapeData {
  std::vector<uint32_t> words;
  uint64_t revision = 0;        ///< unique in the process; another one after every change but of bends
  std::vector<uint32_t> bends;  ///< first words of MovingBends

  /// Appends what the primitive needs, unless it is there; returns its first word. Throws Error when words
  /// cannot be numbered in 32 bits any more, or a field's samples take more than 2 GiB.
  uint32_t add(const ContactPrimitive& primitive);
  /// Appends a bend that is none, for a field that was added before; returns its first word.
  uint32_t addBend();
  void setBend(uint32_t at, const MovingBend& bend);
  void clear();

 private:
  std::vector<std::pair<const void*, uint32_t>> known_;
};

/// Places `primitive` in the world between the poses of its body at the start and the end of a step of `dt`
/// seconds. `data`: of ShapeData::add.
MovingPrimitive moved(const ContactPrimitive& primitive, const Pose& begin, const Pose& end, float dt,
                      uint32_t data = 0);

/// The bend of a field, which may not be rotated in its body, from one of the body to another.
MovingBend bendOf(const ContactPrimitive& field, const SurfaceBend& begin, const SurfaceBend& end);
/// Bends a field as `bend` has it, which is in ShapeData::words from `at` on.
void bendWith(MovingPrimitive& field, const MovingBend& bend, uint32_t at);

inline bool isBent(const MovingPrimitive& p) {
  return p.kind == static_cast<uint32_t>(PrimitiveKind::kField) && p.extra != 0;
}

/// Distance from `point` to the surface at the end of the step, metres; negative inside. Far from the surface
/// of a field never farther from 0 than the true one. `words`: of the ShapeData.
float signedDistance(const MovingPrimitive& primitive, const Vec3& point,
                     std::span<const uint32_t> words = {});

/// What is farther from a body than this before a substep does not touch it in it: lookReach() of
/// kernels/contact.h. Metres.
constexpr float kLookReach = 2e-3f;

/// Where the shape may be during the step; a plane's has no end on any side.
Box sweptBox(const MovingPrimitive& primitive);

}  // namespace strandcast
