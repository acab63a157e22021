// Public API
// Shapes that hair collides with, and their data in the format of all backends.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/distance_field.h"
#include "core/geometry.h"

namespace strandcast {

/// Intersection of half spaces. Distances are exact inside. Outside, the distance is that to the farthest
/// plane: a lower bound in front of edges and corners.
struct ConvexBody {
  std::vector<std::array<float, 4>> planes;  ///< unit normal out of the body; distance from the origin, m
  Box bounds;
};

/// Planes of a closed convex mesh, at most 1024; coplanar triangles share one. Throws Error if a vertex lies
/// in front of a triangle's plane by more than `tolerance` x the mesh's diagonal. Also if the mesh is open,
/// has no volume or has too many planes.
ConvexBody convexBody(const TriangleMesh& mesh, float tolerance = 1e-4f);

/// Kinds of contact primitives. core/body_surface.glsl repeats the values.
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

/// A collision shape, in the frame of its body.
struct ContactPrimitive {
  PrimitiveKind kind = PrimitiveKind::kSphere;
  Vec3 a = Vec3::Zero();   ///< m; sphere, ellipsoid, box: centre; capsules: one end; plane: a point on it;
                           ///< convex and field: origin of its own frame
  Vec3 b = Vec3::UnitY();  ///< capsules: the other end, m; plane: unit normal; otherwise unused
  float radius = 0;        ///< m; sphere and capsules (tapered: at a)
  float friction = 0.3f;   ///< Coulomb coefficient, 0 or more
  float radius_b = 0;      ///< m; tapered capsule: radius at b
  Vec3 extent = Vec3::Zero();  ///< m; ellipsoid: half axes, in a ratio of at most 100; box: half edges
  Quat rotation =
      Quat::Identity();  ///< from the shape's own axes to the body's; ellipsoid, box, convex and field
  std::shared_ptr<const ConvexBody> convex{};    ///< required for kConvex
  std::shared_ptr<const DistanceField> field{};  ///< required for kField
};

/// Throws Error, naming `where`, if a number is not finite or out of range, or if what the kind needs is
/// missing.
void checkPrimitive(const ContactPrimitive& primitive, const std::string& where);

/// A contact primitive in the world over one step, in the format of all backends: eight 4-vectors, 128 bytes,
/// one layout for the CPU arrays and for GLSL std430. Coordinates are relative to the origin of the
/// StepInput. Within the step, positions are interpolated linearly and rotations as interpolateRotation()
/// does. Kinds with a rotation rotate about a, which is their centre.
struct alignas(16) MovingPrimitive {
  float a_begin[3];
  float radius;  ///< m; kinds with a rotation: radius of a ball about a that contains the shape, however it
                 ///< is bent
  float a_end[3];
  uint32_t kind;  ///< PrimitiveKind
  float b_begin[3];
  float friction;
  float b_end[3];
  float radius_b;
  float angular_velocity[3];  ///< rad/s; surface point p has velocity v_a + angular_velocity x (p - a)
  uint32_t data;              ///< convex and field: first word in ShapeData::words
  float rotation_begin[4];    ///< x y z w
  float rotation_end[4];
  float extent[3];
  uint32_t extra;  ///< convex: number of planes; field: first word of its MovingBend, 0 = not bent
};
static_assert(sizeof(MovingPrimitive) == 128);

/// Data of convex bodies and fields in the format of all backends: 32-bit words. A convex body consists of
/// the unit normal and distance of each plane as floats. A field consists of its FieldGrid, index, samples,
/// corners and evenness. Both are translated so that their centre is at the origin. The bends of fields,
/// which change from step to step, are stored here, too.
struct ShapeData {
  std::vector<uint32_t> words;
  uint64_t revision = 0;        ///< unique in the process; changes with every change except of bends
  std::vector<uint32_t> bends;  ///< first words of all MovingBends

  /// Appends the data of a primitive unless they are there; returns their first word. Throws Error if word
  /// indices would exceed 32 bits, or if a field's samples take more than 2 GiB.
  uint32_t add(const ContactPrimitive& primitive);
  /// Appends a zero bend for a field that was added before; returns its first word.
  uint32_t addBend();
  /// Replaces the MovingBend at first word `at`, a result of addBend().
  void setBend(uint32_t at, const MovingBend& bend);
  /// Removes all data; first words of before are invalid.
  void clear();

 private:
  std::vector<std::pair<const void*, uint32_t>> known_;
};

/// Places a primitive in the world. `begin`, `end`: poses of its body at the start and the end of a step of
/// `dt` seconds; `data`: result of ShapeData::add().
MovingPrimitive moved(const ContactPrimitive& primitive, const Pose& begin, const Pose& end, float dt,
                      uint32_t data = 0);

/// Bend of a field over a step, from the bends of its body. Precondition: the field is not rotated in its
/// body.
MovingBend bendOf(const ContactPrimitive& field, const SurfaceBend& begin, const SurfaceBend& end);
/// Applies `bend`, which is in ShapeData::words from `at` on, to a field.
void applyBend(MovingPrimitive& field, const MovingBend& bend, uint32_t at);

inline bool isBent(const MovingPrimitive& p) {
  return p.kind == static_cast<uint32_t>(PrimitiveKind::kField) && p.extra != 0;
}

/// Signed distance from `point` to the surface at the end of the step, m; negative inside. Far from the
/// surface of a field it is never farther from 0 than the true one. `words`: of the ShapeData.
float signedDistance(const MovingPrimitive& primitive, const Vec3& point,
                     std::span<const uint32_t> words = {});

/// A vertex farther from a body than this before a substep does not touch it in the substep, m: queryReach()
/// of kernels/contact.h.
constexpr float kQueryReach = 2e-3f;

/// Bounds of the shape over the step, m; a plane's are infinite on all sides.
Box sweptBox(const MovingPrimitive& primitive);

}  // namespace strandcast
