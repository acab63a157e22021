#pragma once
#include <vector>

#include "collision/mesh_check.h"
#include "collision/mesh_query.h"

namespace strandcast {

/// Where and how far a point is of a body whose mesh may be open.
struct BodyPoint {
  float signed_distance = 0;  ///< m, negative inside
  bool to_lid = false;        ///< the nearest is not the mesh but the lid over a hole
  bool in_doubt = false;      ///< the winding number is nearer to a half than to a whole number
};

/// Signed distance to the surface of a body. Inside is where the generalised winding number (Jacobson 2013)
/// is above a half in size. Over a hole of an open mesh that ends without a surface, on a *lid*; the distance
/// to the lid is estimated to first order, | |w| - 1/2 | / |grad w| (Taubin 1994), and counts as well, so
/// that the distance is continuous there. The gradient of the winding number is that of the mesh's boundary
/// alone, the field of a current along its open edges.
///
/// `whole` is what winds, `outer` what distances are to: the same mesh, or without what lies inside. All
/// three are kept by reference.
class BodyDistance {
 public:
  BodyDistance(const MeshQuery& whole, const MeshQuery& outer, const std::vector<OpenEdge>& open_edges)
      : whole_(whole), outer_(outer), open_edges_(open_edges) {}

  BodyPoint at(const Vec3& point) const { return at(point, outer_.distance(point)); }
  /// The same with the distance to the mesh known.
  BodyPoint at(const Vec3& point, float distance) const;
  /// To the mesh, or `bound` where that is less.
  float toMesh(const Vec3& point, float bound) const { return outer_.distance(point, bound); }

  Vec3 nearestOnMesh(const Vec3& point) const { return outer_.closest(point).position; }

  /// Whether no lid is nearer than the mesh to any point of the ball: then the sign changes only through the
  /// mesh. May miss some balls of which that holds.
  bool clearOfLids(const Vec3& centre, float radius) const;

 private:
  const MeshQuery &whole_, &outer_;
  const std::vector<OpenEdge>& open_edges_;
};

/// Signed distances at places of which each lies near the one before. The way there bounds the distance,
/// which spares most of the search; and where no lid is near, a way shorter than the distance to the mesh
/// does not change the sign.
class DistanceWalk {
 public:
  explicit DistanceWalk(const BodyDistance& body) : body_(body) {}

  /// `clear_of_lids`: of all places up to the next start.
  float start(const Vec3& place, bool clear_of_lids);
  /// `step`: m, from the last place.
  float next(const Vec3& place, float step);

 private:
  const BodyDistance& body_;
  bool clear_of_lids_ = false;
  float to_mesh_ = 0, signed_ = 0;  // of the last place
};

}  // namespace strandcast
