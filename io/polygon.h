#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry.h"

namespace strandcast {

/// Triangulates polygons that are flat or nearly so, convex or not.
///
/// The plane is that of the polygon's area vector (Newell's method; Tampieri, "Newell's method for computing
/// the plane equation of a polygon", Graphics Gems III, 1992). A flat polygon is fanned from its first corner
/// where that fan covers it once. Other polygons are triangulated by ear clipping, best ear first (Meisters,
/// "Polygons have ears", 1975), in an order that depends on the positions alone. The surface therefore does
/// not depend on the corner with which a file begins the polygon. Triangles have the winding of their
/// polygon.
///
/// Collinear corners, coincident corners, and bridges to holes, which a polygon passes twice, are allowed.
///
/// The time for a polygon is proportional to its corners times its reflex corners. The total for all polygons
/// of one PolygonCutter is limited, see isSpent().
class PolygonCutter {
 public:
  using Triangle = std::array<uint32_t, 3>;

  /// `positions`: in any unit, finite; must outlive the cutter. All corners are indices into them.
  /// `max_tests`: limit on tests of a corner against an ear, see isSpent(). The default takes some seconds.
  explicit PolygonCutter(std::span<const Vec3> positions, uint64_t max_tests = 1'000'000'000)
      : positions_(positions), max_tests_(max_tests) {}

  /// Appends the triangles of one polygon, two fewer than it has corners; triangles that use a vertex twice
  /// are left out. Returns false when the triangles do not cover the polygon once, because it has no area or
  /// intersects itself.
  bool cut(std::span<const uint32_t> corners, std::vector<Triangle>& triangles);

  /// Whether the polygons so far needed more tests than allowed. The last polygon may then lack triangles,
  /// and no further one should be cut.
  bool isSpent() const { return tests_ > max_tests_; }

 private:
  struct Corner {
    uint32_t vertex;
    Eigen::Vector2d at;  ///< in the plane of the polygon, seen from the side where it is counter-clockwise
    uint32_t before, after;
    double quality;  ///< of the ear with this corner as its tip; negative where there is no ear
    bool is_gone, is_inward;
  };

  void gather(std::span<const uint32_t> corners);
  bool flatten();
  bool fan(std::vector<Triangle>& triangles) const;
  void rotateToLeast();
  void link();
  bool turnsOnce() const;
  bool clip(std::vector<Triangle>& triangles);
  uint32_t tipWithoutEar(uint32_t from, bool& covers_once) const;
  double earQuality(uint32_t tip);
  void add(uint32_t a, uint32_t b, uint32_t c, std::vector<Triangle>& triangles) const;
  double turnAt(uint32_t corner) const;

  std::span<const Vec3> positions_;
  uint64_t max_tests_;
  std::vector<Corner> ring_;
  std::vector<uint32_t> inward_;  ///< reflex corners of the ring, and ones that were before the last cut
  bool is_flat_ = false;
  double no_area_ = 0;  ///< twice the area below which a triangle counts as degenerate
  uint64_t tests_ = 0;
};

}  // namespace strandcast
