#pragma once
#include <cstddef>
#include <limits>
#include <memory>

#include "core/triangle_mesh.h"

namespace strandcast {

struct MeshPoint {
  Vec3 position = Vec3::Zero();  ///< m
  uint32_t triangle = 0;
  Vec3 barycentric{1, 0, 0};
  float distance = 0;  ///< m, unsigned
};

/// Closest points and insideness of a mesh; FCL's bounding volume hierarchy underneath. Thread-safe for
/// queries.
class MeshQuery {
 public:
  /// Keeps a copy of the mesh. Throws Error on an empty mesh, an index out of range or a vertex that is not
  /// finite.
  explicit MeshQuery(const TriangleMesh& mesh);
  ~MeshQuery();
  MeshQuery(MeshQuery&&) noexcept;

  MeshPoint closest(const Vec3& point) const;
  /// The distance alone, or `bound` where that is less: the same number sooner when a bound is known, as from
  /// a neighbouring point.
  float distance(const Vec3& point, float bound = std::numeric_limits<float>::infinity()) const;
  /// Generalised winding number (Jacobson 2013): about 1 inside, 0 outside, in between near holes of an open
  /// mesh.
  float windingNumber(const Vec3& point) const;
  /// Negative inside.
  float signedDistance(const Vec3& point) const;

  /// Memory that making a query over so many triangles takes.
  static size_t bytes(size_t triangles);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace strandcast
