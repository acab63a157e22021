#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "air/wind.h"
#include "air/wind_source.h"
#include "core/backend.h"
#include "core/geometry.h"

namespace strandcast {

/// State of the air and the hair at a point.
struct AirSample {
  float density = 0;         ///< kg/m^3, mass of strands per volume; 0 outside the hair grid
  Vec3 wind = Vec3::Zero();  ///< m/s
  float pressure = 0;        ///< Pa, relative to the pressure outside the grid
  float divergence = 0;      ///< 1/s, including the outflow of sphere sources
  bool solid = false;        ///< the cell of the wind grid is inside a body
};

/// Read access to the grids of a simulation after a step. Precondition of box(), cell() and at():
/// hasDensity() or hasWind().
class AirFields {
 public:
  virtual ~AirFields() = default;
  /// Whether hair was splatted in the newest step: for forces between hairs, or because hair drags the air.
  virtual bool hasDensity() const = 0;
  /// Whether the newest step had a wind grid (parameter wind_grid = 1).
  virtual bool hasWind() const = 0;
  /// m, world frame: the box of the wind grid, or of the hair grid where there is no wind grid.
  virtual Box box() const = 0;
  virtual float cell() const = 0;  ///< m, edge of a cell of the grid of box()
  /// `point`: m, world frame. Quantities that are on no grid are 0.
  virtual AirSample at(const Vec3& point) const = 0;
};

/// The air: external forces whose grids can be read and whose wind sources can be replaced between steps.
class AirSystem : public ExternalForces, public AirFields {
 public:
  /// Replaces all sources, in the world frame, from the next step on. The velocity of the air is kept.
  /// Precondition: each source passes checkWindSource(). May allocate. When the first source is added or the
  /// last one removed, the caller must call Simulation::setParameters(), which queries
  /// ExternalForces::isNeeded() again.
  virtual void setSources(std::vector<WindSource> sources) = 0;

  AirSystem* airSystem() final { return this; }
};

/// The air system that these forces are; null where they are null or of another kind.
inline AirSystem* airSystem(ExternalForces* forces) { return forces ? forces->airSystem() : nullptr; }

/// Factory functions of a backend for air and for forces between hairs.
struct AirFactory {
  /// Makes the air system: wind grid and hair grid (docs/air.md). Throws Error for a source out of range.
  std::function<std::unique_ptr<AirSystem>(std::vector<WindSource>)> make;
  /// Makes a wind grid alone. `cell`: m.
  std::function<std::unique_ptr<Wind>(int cells, float cell, Wind::Border)> wind;
};

/// Makers of the CPU backends: "reference" (float, scalar, one thread), "oracle" (the same in double) or
/// "simd" (vectors, `threads` threads, 0 = all). Throws Error on another name.
AirFactory cpuAir(const std::string& backend, int threads = 0);

}  // namespace strandcast
