#pragma once
#include <functional>
#include <optional>

#include "groom/groom.h"

namespace strandcast {

/// A place on a surface nearest to a point.
struct SurfacePoint {
  Vec3 position = Vec3::Zero();  ///< m
  uint32_t triangle = 0;
  Vec3 barycentric{1, 0, 0};  ///< sums to 1
  float distance = 0;         ///< m, unsigned
};
/// Nearest place on the scalp: collision/ makes one from a mesh.
using ClosestPoint = std::function<SurfacePoint(const Vec3&)>;

/// Makes strands that the solver can take (makeStrandModel): merges neighbouring vertices nearer to each
/// other than kShortestEdge of the strand's mean edge, below which the rod's forces are no gradient and feed
/// motion (root and tip stay, pins go to the one that stays), drops strands with fewer than
/// 2 vertices then or shorter than 1 % of the median, evens strands of more than 128 vertices down to 128.
/// Adds what it did to `groom.report`. Positions must be finite.
void cleanStrands(Groom& groom);

/// Turns round strands whose tip is nearer the scalp than their root (by more than half their length),
/// and counts them in `groom.report.reversed`. The new root is pinned; the old one stays pinned only on
/// strands pinned at both ends.
void orientRoots(Groom& groom, const ClosestPoint& scalp);

/// Gives every strand `vertices` vertices on its polyline, 2 to 128 (Error otherwise), as far from each
/// other: its edges are of one length. Where a strand comes back to itself so that no such edges end at its
/// tip, its vertices are at equal distances along it. Root and tip are kept bit for bit, the length as well
/// as a polyline of that many vertices can: never longer, shorter by the corners cut. Radii are interpolated;
/// a pinned vertex pins the new one nearest to it, and those between it and a pinned neighbour. UVs and parts
/// are carried over. A strand that runs back along itself can get two vertices into one place: clean again
/// where that may be.
StrandSet resample(const StrandSet& strands, int vertices);
/// The same with each strand's own count, capped at `max_vertices` (2 to 128).
StrandSet equalize(const StrandSet& strands, int max_vertices);

/// `count` strands whose roots are spread as evenly as can be, in their order in the groom; all of them when
/// there are no more. Farthest point first, starting from the root farthest from the roots' centre, lower
/// indices first among equals: no chance is in it.
std::vector<uint32_t> chooseGuides(const StrandSet& strands, size_t count);
/// The chosen strands, in the order given, with their pins, radii, UVs and parts. Error on an index out of
/// range.
StrandSet subset(const StrandSet& strands, const std::vector<uint32_t>& chosen);

/// How the roots hang on the scalp.
struct RootBinding {
  std::vector<SurfacePoint> roots;  ///< per strand
  float mean_distance = 0;          ///< m, roots off the scalp
  float max_distance = 0;           ///< m
};
/// Binds every root to its nearest place on the scalp. Strands must have a vertex.
RootBinding bindRoots(const StrandSet& strands, const ClosestPoint& scalp);

}  // namespace strandcast
