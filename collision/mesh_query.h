#pragma once
#include <cstddef>
#include <limits>
#include <memory>

#include "core/geometry.h"

namespace strandcast {

/// Closest point of a mesh.
struct MeshPoint {
  Vec3 position = Vec3::Zero();  ///< m
  uint32_t triangle = 0;
  Vec3 barycentric{1, 0, 0};  ///< sums to 1
  float distance = 0;         ///< m, unsigned
};

/// Closest points and winding numbers of a mesh, with FCL's bounding volume hierarchy. Queries are
/// thread-safe.
class MeshQuery {
 public:
  /// Keeps a copy of the mesh. Throws Error on an empty mesh, an index out of range or a vertex that is not
  /// finite.
  explicit MeshQuery(const TriangleMesh& mesh);
  ~MeshQuery();
  MeshQuery(MeshQuery&&) noexcept;

  /// Closest point of the mesh. A default MeshPoint if `point` is not finite.
  MeshPoint closest(const Vec3& point) const;
  /// The distance alone, m, or `bound` if that is less. A bound known from a neighbouring point makes the
  /// query faster.
  float distance(const Vec3& point, float bound = std::numeric_limits<float>::infinity()) const;
  /// Generalised winding number (Jacobson 2013): about 1 inside, 0 outside, fractional near holes of an open
  /// mesh.
  float windingNumber(const Vec3& point) const;
  /// Distance in m, negative inside.
  float signedDistance(const Vec3& point) const;

  /// Bytes needed to make a query of so many triangles.
  static size_t bytes(size_t triangles);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace strandcast
