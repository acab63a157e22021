#pragma once
#include "core/geometry.h"

namespace strandcast {

class Surroundings;

/// What is known of the air and of the hair in it at a point.
struct AirSample {
  float density = 0;         ///< kg/m^3, of the strands themselves; 0 beyond their grid
  Vec3 wind = Vec3::Zero();  ///< m/s
  float pressure = 0;        ///< Pa, over that beyond the grid
  float divergence = 0;      ///< 1/s, also what spheres of wind let out
  bool solid = false;        ///< in a body, as the wind grid sees it
};

/// The grids of a simulation, to be looked at after a step. Where it has neither density nor wind there is
/// nothing else to ask.
class AirFields {
 public:
  virtual ~AirFields() = default;
  /// Hair is on a grid: settings ask for forces between hairs, or for wind that hair holds back.
  virtual bool hasDensity() const = 0;
  /// wind_grid is 1.
  virtual bool hasWind() const = 0;
  /// m, world: the wind's grid, or that of the hair where there is no wind.
  virtual Box box() const = 0;
  virtual float cell() const = 0;  ///< m, of that grid
  /// What has no grid is 0.
  virtual AirSample at(const Vec3& point) const = 0;
};

/// The grids of surroundings that cpuAir() or gpuAir() made; null for others.
const AirFields* airFields(const Surroundings* surroundings);

}  // namespace strandcast
