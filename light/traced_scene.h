// The geometry that a path tracer's rays meet: hair as round tapered segments, bodies as triangles.
#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "core/geometry.h"

namespace strandcast {

/// Hairs of a picture, root to tip, one after another.
struct TracedHair {
  std::vector<uint32_t> offsets{0};  ///< first vertex per hair, and the end; hairs + 1
  std::vector<Vec3> positions;       ///< m, world; those of a hair differ
  std::vector<Vec3> tangents;        ///< unit, towards the tip; per vertex
  std::vector<float> radii;          ///< m, above 0 to 0.1; per vertex
  /// Per hair, absorption of red, green and blue per radius at root and tip, at least 0; linear between.
  std::vector<std::array<Vec3, 2>> absorption;

  size_t hairs() const { return offsets.size() - 1; }
};

/// Triangles of one material.
struct TracedMesh {
  TriangleMesh mesh;      ///< m, world; with normals, or flat where there are none
  uint32_t material = 0;  ///< the caller's
};

/// Where a ray meets the scene.
struct TracedHit {
  enum class Kind { kNothing, kHair, kSurface } kind = Kind::kNothing;
  double distance = 0;       ///< m along the ray
  Eigen::Vector3d position;  ///< m, relative to TracedScene::origin()
  uint32_t part = 0;         ///< hair, or index of the mesh
  uint32_t primitive = 0;    ///< segment, or triangle
  Eigen::Vector3d normal;    ///< of a surface: unit, geometric, on the ray's side
  Eigen::Vector3d shading;   ///< of a surface: unit, interpolated, on the side of `normal`
  Eigen::Vector3d tangent;   ///< of a hair: unit, interpolated, towards the tip
  Eigen::Vector3d axis;      ///< of a hair: unit, of the segment
  Eigen::Vector3d center;    ///< of a hair: the point of the axis across from `position`
  double radius = 0;         ///< m, of the hair there
  double along = 0;          ///< of a hair: fraction of its vertices passed, 0 to 1
};

/// Immutable; const functions may be called from many threads. Hits do not depend on the number of threads.
///
/// A segment of hair is a cone frustum between two vertices, closed by flat ends, met by an own test in
/// double precision. Embree's linear curves of constant radius miss rays along them. A ray that starts inside
/// a segment does not meet it: overlaps of neighbours at a bend scatter nothing.
class TracedScene {
 public:
  /// Throws Error where a vertex, tangent, radius or absorption is out of range; triangles with corners out
  /// of range or not finite are left out.
  TracedScene(TracedHair hair, std::vector<TracedMesh> meshes);
  ~TracedScene();
  TracedScene(const TracedScene&) = delete;
  TracedScene& operator=(const TracedScene&) = delete;

  /// Subtracted from all positions, so that rays are traced near 0, where floats are fine; m, world.
  const Eigen::Vector3d& origin() const { return origin_; }
  const TracedHair& hair() const { return hair_; }
  /// TracedMesh::material of a hit's part.
  uint32_t material(uint32_t mesh) const { return meshes_[mesh].material; }
  size_t segments() const { return segments_.size(); }
  /// m: largest distance of geometry from origin().
  double radius() const { return radius_; }

  /// `start`: m, relative to origin(). `direction`: unit. `left`: the hit that the ray leaves, or null; its
  /// segment is not met again.
  TracedHit hit(const Eigen::Vector3d& start, const Eigen::Vector3d& direction,
                const TracedHit* left = nullptr) const;
  /// Whether anything lies between `start` and `distance` (m; may be infinite) along the ray.
  bool isBlocked(const Eigen::Vector3d& start, const Eigen::Vector3d& direction, double distance,
                 const TracedHit* left = nullptr) const;
  /// Where a ray in a direction leaves from a hit: outside the fibre on the direction's side, or above the
  /// surface. m, relative to origin().
  Eigen::Vector3d departure(const TracedHit& hit, const Eigen::Vector3d& direction) const;

 private:
  struct Segment {
    float begin[3], begin_radius, end[3], end_radius;
    uint32_t hair, vertex;
  };
  struct Embree;
  struct Query;

  static double enter(const Segment& segment, const Eigen::Vector3d& start, const Eigen::Vector3d& direction);
  void completeHair(TracedHit& hit, const Eigen::Vector3d& start, const Eigen::Vector3d& direction) const;
  void completeSurface(TracedHit& hit, double u, double v, const Eigen::Vector3d& direction) const;

  TracedHair hair_;
  std::vector<TracedMesh> meshes_;
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
  double radius_ = 0;
  int boxes_ = 1;  ///< per segment
  std::vector<Segment> segments_;
  std::unique_ptr<Embree> embree_;
};

}  // namespace strandcast
