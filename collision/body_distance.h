// Inside and outside of a body whose mesh may be open: signed distance, outer surface, doubt.
#pragma once
#include <array>
#include <atomic>
#include <vector>

#include "collision/mesh_query.h"
#include "collision/mesh_repair.h"
#include "core/geometry.h"

namespace strandcast {

/// A point of a surface with its normal.
struct SurfaceSample {
  Vec3 position;  ///< m
  Vec3 normal;    ///< unit length, of its triangle
};

/// `count` points distributed over the surface by area, fewer if triangles have no area. Barycentric
/// coordinates follow a golden-ratio sequence. Each point represents the same area.
std::vector<SurfaceSample> sampleSurface(const TriangleMesh& mesh, size_t count);

/// Share, 0 to 1, of the surface of `mesh` where the inside-outside test is uncertain on one side, at a
/// distance `step` (m). Uncertain: the magnitude of the winding number is nearer to a half than to an
/// integer.
double uncertainShare(const TriangleMesh& mesh, const MeshQuery& query, float step);

/// Inside-outside test: whether the magnitude of the winding number is above a half. Thereby an inside-out
/// mesh has the same inside.
bool isInside(const MeshQuery& query, const Vec3& point);

/// Whether there is outside on either side of the surface at `place`, at a distance `step` (m, along the
/// normal). If both sides are inside, the surface there is an internal part, or a part that reaches into
/// another one.
bool boundsOutside(const MeshQuery& query, const Vec3& place, const Vec3& step);

/// The parts of a triangle that bound the outside: the whole, none, or pieces of it. Pieces are cut so that a
/// rim of about `resolution` (m) of the hidden part remains. In a triangle with edges longer than that, a
/// hidden part is found if it is larger than an eighth of the edges. Triangles without area are treated
/// alike. Returns early when `stop` is set.
std::vector<std::array<Vec3, 3>> outerPieces(const MeshQuery& query, const std::array<Vec3, 3>& triangle,
                                             float resolution, const std::atomic<bool>& stop);

/// Signed distance of a point from a body whose mesh may be open.
struct BodyPoint {
  float signed_distance = 0;  ///< m, negative inside
  bool to_lid = false;        ///< the nearest surface is a lid over a hole, not the mesh
  bool in_doubt = false;      ///< the winding number is nearer to a half than to an integer
};

/// Signed distance to the surface of a body. Inside is where the magnitude of the generalised winding number
/// (Jacobson 2013) is above a half.
///
/// Over a hole of an open mesh the inside ends without a surface, at a *lid*. The distance to the lid is
/// estimated to first order, | |w| - 1/2 | / |grad w| (Taubin 1994), and counts as well, so that the distance
/// is continuous there. The gradient of the winding number depends on the mesh's boundary alone: it is the
/// field of a current along the open edges.
///
/// `whole` determines the winding number, `outer` the distance to the mesh: the same mesh, or without the
/// parts inside. All three arguments must outlive the object.
class BodyDistance {
 public:
  BodyDistance(const MeshQuery& whole, const MeshQuery& outer, const std::vector<OpenEdge>& open_edges)
      : whole_(whole), outer_(outer), open_edges_(open_edges) {}

  BodyPoint at(const Vec3& point) const { return at(point, outer_.distance(point)); }
  /// As above, with the distance to the mesh already known.
  BodyPoint at(const Vec3& point, float distance) const;
  /// Distance to the mesh, or `bound` if that is less.
  float toMesh(const Vec3& point, float bound) const { return outer_.distance(point, bound); }

  Vec3 nearestOnMesh(const Vec3& point) const { return outer_.closest(point).position; }

  /// Whether the mesh is nearer than any lid to each point of the ball. The sign then changes only through
  /// the mesh. Conservative: may return false although this holds.
  bool clearOfLids(const Vec3& centre, float radius) const;

 private:
  const MeshQuery &whole_, &outer_;
  const std::vector<OpenEdge>& open_edges_;
};

/// Signed distances along a sequence of neighbouring points. The step length bounds the distance at the next
/// point, which saves most of the search. Where no lid is near, a step shorter than the distance to the mesh
/// does not change the sign.
class DistanceWalk {
 public:
  explicit DistanceWalk(const BodyDistance& body) : body_(body) {}

  /// Starts at `place`. `clear_of_lids`: clearOfLids() holds for all points up to the next start().
  float start(const Vec3& place, bool clear_of_lids);
  /// Goes to `place`, which is `step` (m) from the previous point.
  float next(const Vec3& place, float step);

 private:
  const BodyDistance& body_;
  bool clear_of_lids_ = false;
  float to_mesh_ = 0, signed_ = 0;  // at the previous point
};

}  // namespace strandcast
