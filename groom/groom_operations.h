#pragma once
#include <functional>
#include <optional>

#include "groom/groom.h"

namespace strandcast {

/// Closest point of a surface to a query point.
struct SurfacePoint {
  Vec3 position = Vec3::Zero();  ///< m
  uint32_t triangle = 0;
  Vec3 barycentric{1, 0, 0};  ///< sums to 1
  float distance = 0;         ///< m, unsigned
};
/// Closest-point query on the scalp. collision/ makes one from a mesh.
using ClosestPoint = std::function<SurfacePoint(const Vec3&)>;

/// Makes strands valid for the solver (makeStrandModel). Positions must be finite. Three steps, each counted
/// in `groom.report`:
/// - Neighbouring vertices nearer to each other than kShortestEdge of the strand's mean edge are merged. On
///   shorter edges the forces of the rod are no gradient and add energy. Root and tip stay; the vertex that
///   stays takes over the pin.
/// - Strands are dropped that then have fewer than 2 vertices, or are shorter than 1 % of the median length.
/// - Strands of more than 128 vertices are resampled to 128.
void cleanStrands(Groom& groom);

/// Reverses strands whose tip is nearer the scalp than their root by more than half their length, and counts
/// them in `groom.report.reversed`. The new root is pinned. The old root stays pinned only on strands pinned
/// at both ends.
void orientRoots(Groom& groom, const ClosestPoint& scalp);

/// Gives each strand `vertices` vertices on its polyline, 2 to 128 (Error otherwise), with edges of equal
/// length. A strand that returns to itself may have no such vertices that end at its tip; its vertices then
/// are at equal arc lengths.
///
/// Root and tip are kept bit for bit. The new polyline is never longer than the old one, and shorter by the
/// corners cut. Radii are interpolated; all values per strand are carried over. A pinned vertex pins the new
/// vertex nearest to it. New vertices between two pinned neighbours are pinned as well. A strand that runs
/// back along itself can get two coincident vertices: call cleanStrands() again where that may occur.
StrandSet resample(const StrandSet& strands, int vertices);
/// As resample(), with each strand's own count of vertices, capped at `max_vertices` (2 to 128).
StrandSet equalize(const StrandSet& strands, int max_vertices);

/// Selects `count` strands whose roots are spread as evenly as possible; all strands when there are no more
/// than that. Indices are ascending. Farthest point sampling, starting from the root farthest from the centre
/// of all roots. Of equal candidates the lower index is taken, so the result is deterministic.
std::vector<uint32_t> chooseGuides(const StrandSet& strands, size_t count);
/// Copies the chosen strands in the given order, with pins, radii and all values per strand. Error on an
/// index out of range.
StrandSet subset(const StrandSet& strands, const std::vector<uint32_t>& chosen);

/// Attachment of the roots to the scalp.
struct RootBinding {
  std::vector<SurfacePoint> roots;  ///< per strand, the closest point of the scalp
  float mean_distance = 0;          ///< m, mean distance of the roots from the scalp
  float max_distance = 0;           ///< m
};
/// Binds each root to its closest point on the scalp. Precondition: each strand has a vertex.
RootBinding bindRoots(const StrandSet& strands, const ClosestPoint& scalp);

}  // namespace strandcast
