#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry.h"

namespace strandcast {

/// Cuts polygons that are flat or nearly so, convex or not, into triangles.
///
/// The plane is that of the polygon's area vector (Newell's method; Tampieri, "Newell's method for computing
/// the plane equation of a polygon", Graphics Gems III, 1992). A flat polygon is fanned from its first corner
/// where that fan covers it once. Of other polygons the best ear is cut off again and again (Meisters,
/// "Polygons have ears", 1975), in an order that depends on the positions alone. The surface therefore does
/// not depend on the corner that a file begins with. Triangles turn as their polygon does.
///
/// Corners in one line, corners in one place, and bridges to holes, which a polygon passes twice, are
/// allowed.
///
/// The time for a polygon is the product of its corners and of those that point inward. What all polygons of
/// one PolygonCutter may take is limited, see isSpent().
class PolygonCutter {
 public:
  using Triangle = std::array<uint32_t, 3>;

  /// `positions`: in any unit, finite. All corners are indices into them. They have to outlive the cutter.
  /// `most_tests`: of a corner against an ear, see isSpent(); the usual number is some seconds' work.
  explicit PolygonCutter(std::span<const Vec3> positions, uint64_t most_tests = 1'000'000'000)
      : positions_(positions), most_tests_(most_tests) {}

  /// Adds the triangles of one polygon. There are two fewer than corners; those with one vertex twice are
  /// left out. Returns false where the triangles do not cover the polygon once: it has no area, or crosses
  /// itself.
  bool cut(std::span<const uint32_t> corners, std::vector<Triangle>& triangles);

  /// Whether the polygons up to now took more tests than there are. The last one may lack triangles then, and
  /// no further one should be cut.
  bool isSpent() const { return tests_ > most_tests_; }

 private:
  struct Corner {
    uint32_t vertex;
    Eigen::Vector2d at;  ///< in the polygon's plane, seen from where the polygon turns left
    uint32_t before, after;
    double quality;  ///< of the ear that this corner is the tip of; negative where it is not one
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
  uint64_t most_tests_;
  std::vector<Corner> ring_;
  std::vector<uint32_t> inward_;  ///< corners of the ring that point inward, or did before the last cut
  bool is_flat_ = false;
  double no_area_ = 0;  ///< twice the area below which a triangle counts as a line
  uint64_t tests_ = 0;
};

}  // namespace strandcast
