#pragma once
#include <span>
#include <string>
#include <vector>

#include "core/geometry.h"

namespace strandcast {

/// A source of wind, in the world frame. On a grid, air in reach of a cone or turbine approaches the source's
/// velocity at the rate `rate`; a sphere emits air.
struct WindSource {
  enum class Kind {
    kCone,  ///< a fan: from `position` along `direction` within `angle`; the speed falls linearly to 0 at
            ///< `length`
    /// Radially out of `position` (inwards where speed is negative), within `radius`. On a grid it emits
    /// 4 pi radius^2 speed of air (absorbs it where negative): SphereOnGrid.
    kSphere,
    kTurbine  ///< a disc across `direction` of `radius` and thickness `length`; blows along the axis, with
              ///< swirl
  };
  Kind kind = Kind::kCone;
  Vec3 position = Vec3::Zero();    ///< m
  Vec3 direction = Vec3::UnitZ();  ///< of any length from 0.001 to 1000
  float radius = 0.2f;             ///< m, sphere and turbine
  float length = 0.5f;             ///< m, cone and turbine
  float angle = 0.35f;             ///< rad, half the cone's opening
  float speed = 3;                 ///< m/s
  float swirl = 0;                 ///< m/s at a turbine's rim, right-handed about `direction`
  float rate = 20;                 ///< 1/s, on a grid; no meaning for a sphere

  /// Target velocity of air at `point`, m/s; false where the source does not reach.
  bool velocityAt(const Vec3& point, Vec3& velocity) const;
  /// Bounds of the reach, m.
  Box reach() const;
};

/// A source with the name that commands use.
struct NamedWindSource {
  std::string name;
  WindSource source;
};

std::vector<WindSource> withoutNames(const std::vector<NamedWindSource>& named);

/// Bit mask of the parts of a source besides its kind: position, direction, and those of windSourceNumbers().
using WindSourceParts = uint32_t;
inline constexpr WindSourceParts kSourcePosition = 1, kSourceDirection = 2, kAllSourceParts = 255;

/// A number of a source in files and commands.
struct WindSourceNumber {
  WindSourceParts part;  ///< bit of the number
  const char *name, *unit, *help;
  double low, high;         ///< range, in `unit`
  double scale;             ///< `unit` in SI
  float WindSource::*into;  ///< member that holds it, SI
};
/// radius, length, angle, speed, swirl, rate.
std::span<const WindSourceNumber> windSourceNumbers();

/// The parts that a source of this kind uses: a cone has no radius and swirl, a turbine no angle, a sphere
/// only position, radius and speed.
WindSourceParts partsOf(WindSource::Kind kind);
/// The names of those `parts` that a source of this kind does not use: "direction, angle"; empty where it
/// uses all.
std::string unusedParts(WindSource::Kind kind, WindSourceParts parts);
/// Copies `parts` of `of` to `source`.
void copyParts(WindSource& source, const WindSource& of, WindSourceParts parts);
/// Interpolates two sources of the same kind, `part` from 0 to 1: positions and numbers linearly, directions
/// by slerp. The result is valid where both are.
WindSource between(const WindSource& from, const WindSource& to, float part);

/// The source adapted to a grid with cells of `cell` m, which samples it at cell centres. A turbine is at
/// least a cell thick, with the rate reduced in proportion. A sphere has at least a cell's radius, with the
/// same flow.
WindSource onGrid(WindSource source, float cell);

/// A sphere as a source of air on a wind grid (sphereShare() in kernels/grid.h). The outflow of its cells
/// sums to 4 pi radius^2 speed at any position relative to the cells; to 1.5e-4 where the radius is above 24
/// cells. Cells outside the grid or in solids count in that sum, and their share is not emitted.
class SphereOnGrid {
 public:
  /// `corner`: low corner of the grid's cell (0, 0, 0), m; `cell`: m.
  SphereOnGrid(const WindSource& sphere, const Vec3& corner, float cell);

  /// Cells from first() to last(), clamped to `cells` per axis: all that have an outflow.
  Eigen::Vector3i first(int cells) const;
  Eigen::Vector3i last(int cells) const;
  /// Target divergence x cell of a cell, m/s.
  double outflow(int i, int j, int k) const;
  /// outflow() of a cell whose sphereShare() is 1, m/s.
  double perShare() const { return per_share_; }

 private:
  Eigen::Vector3d middle_;  ///< centre, in cells from the corner
  double radius_;           ///< in cells
  double per_share_ = 0;
};

/// The sources translated by `way`, m.
std::vector<WindSource> movedBy(std::vector<WindSource> sources, const Vec3& way);

/// Kind of the name "cone", "sphere" or "turbine". Throws Error, naming `where`, otherwise.
WindSource::Kind windSourceKind(const std::string& name, const std::string& where);
std::string windSourceKindName(WindSource::Kind kind);
/// Throws Error, naming `where`, unless the name has 1 to 64 bytes without spaces and control characters.
void checkWindSourceName(const std::string& name, const std::string& where);
/// Throws Error, naming `where`, where a number is not finite or out of range: lengths above 0 to 100 m,
/// angle above 0 to pi/2, speeds within +-100 m/s, rate 0 to 1000, direction's length 0.001 to 1000.
void checkWindSource(const WindSource& source, const std::string& where);

}  // namespace strandcast
