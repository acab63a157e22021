#pragma once
#include <span>
#include <string>
#include <vector>

#include "core/geometry.h"

namespace strandcast {

/// Something that drives the air of a wind grid, in the world. Air in the reach of a cone or turbine takes on
/// its velocity at the rate `rate`; a sphere is where air comes from.
struct WindSource {
  enum class Kind {
    kCone,  ///< a fan: from `position` along `direction` within `angle`, weaker towards `length`
    /// Out of `position` in all directions (inwards where speed is negative), within `radius`. On a grid
    /// 4 pi radius^2 speed of air begins there (or ends): SphereOnGrid.
    kSphere,
    kTurbine  ///< a disc across `direction` of `radius` and thickness `length` that blows and turns the air
  };
  Kind kind = Kind::kCone;
  Vec3 position = Vec3::Zero();  ///< m
  Vec3 direction = Vec3::UnitZ();
  float radius = 0.2f;  ///< m, sphere and turbine
  float length = 0.5f;  ///< m, cone and turbine
  float angle = 0.35f;  ///< rad, half the cone's opening
  float speed = 3;      ///< m/s
  float swirl = 0;      ///< m/s, of a turbine's rim, right-handed about `direction`
  float rate = 20;      ///< 1/s; not of a sphere

  /// Velocity that air at `point` is drawn to; false where the source does not reach.
  bool velocityAt(const Vec3& point, Vec3& velocity) const;
  /// All that it reaches lies within.
  Box reach() const;
};

/// A source that is steered by its name.
struct NamedWindSource {
  std::string name;
  WindSource source;
};

std::vector<WindSource> withoutNames(const std::vector<NamedWindSource>& named);

/// What a source has, but its kind, bit by bit: position, direction, and those of windSourceNumbers().
using WindSourceParts = uint32_t;
inline constexpr WindSourceParts kSourcePosition = 1, kSourceDirection = 2, kAllSourceParts = 255;

/// A number of a source as files and commands have it.
struct WindSourceNumber {
  WindSourceParts part;  ///< its bit
  const char *name, *unit, *help;
  double low, high;         ///< in `unit`
  double scale;             ///< `unit` in SI
  float WindSource::*into;  ///< where it is kept, SI
};
/// radius, length, angle, speed, swirl, rate.
std::span<const WindSourceNumber> windSourceNumbers();

/// Has `source` have these parts as `of` has them.
void take(WindSource& source, const WindSource& of, WindSourceParts parts);
/// A source `part` (0 to 1) of the way from one to another, which has its kind and is sound as both are: it
/// goes straight and turns evenly.
WindSource between(const WindSource& from, const WindSource& to, float part);

/// As a grid with cells of `cell` m has it, which asks it at their middles only: a turbine is a cell thick at
/// least, and drives the more air the less; a sphere has a cell's radius at least, and lets out as much air.
WindSource onGrid(WindSource source, float cell);

/// A sphere as a source of air on a wind grid (sphereShare in kernels/grid.h): what flows out of its cells
/// sums up to 4 pi radius^2 speed wherever it is among them, to 1.5e-4 where its radius is above 24 cells.
/// Cells that lie beyond the grid's border or in solids have their part of that, and keep it back.
class SphereOnGrid {
 public:
  /// `corner`: low one of the grid's cell (0, 0, 0), m; `cell`: m.
  SphereOnGrid(const WindSource& sphere, const Vec3& corner, float cell);

  /// Cells from first() to last(), of `cells` per axis, are all that have any.
  Eigen::Vector3i first(int cells) const;
  Eigen::Vector3i last(int cells) const;
  /// Of a cell, m/s.
  double outflow(int i, int j, int k) const;
  /// Outflow, m/s, of a cell whose sphereShare() is 1.
  double perShare() const { return per_share_; }

 private:
  Eigen::Vector3d middle_;  ///< in cells from the corner
  double radius_;           ///< in cells
  double per_share_ = 0;
};

std::vector<WindSource> movedBy(std::vector<WindSource> sources, const Vec3& way);

/// "cone", "sphere" or "turbine"; Error, naming `where`, otherwise.
WindSource::Kind windSourceKind(const std::string& name, const std::string& where);
std::string windSourceKindName(WindSource::Kind kind);
/// Throws Error, naming `where`, unless it is of 1 to 64 bytes without spaces and control characters.
void checkWindSourceName(const std::string& name, const std::string& where);
/// Throws Error, naming `where`, where a number is not finite or out of range: lengths above 0 to 100 m,
/// angle above 0 to pi/2, speeds within +-100 m/s, rate 0 to 1000, direction's length 0.001 to 1000.
void checkWindSource(const WindSource& source, const std::string& where);

}  // namespace strandcast
