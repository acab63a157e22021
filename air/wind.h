#pragma once
#include <functional>
#include <span>

#include "air/ambient.h"
#include "air/wind_source.h"
#include "core/contact_primitive.h"

namespace strandcast {

/// How a solve of the pressure went.
struct PressureReport {
  int iterations = 0;
  double residual = 0;  ///< the largest of a cell, m/s
};

/// Air in a box of cubic cells, staggered, incompressible: one step is advection, viscosity, exchange of
/// momentum (hair, sources), projection (Stam 1999; Bridson 2015, "Fluid Simulation for Computer Graphics").
/// Open: the pressure at the border is 0 and what flows in is that of `ambient`. Closed: walls without
/// friction. World axes; the box is moved by whole cells. This is what every backend's can be asked and told.
class Wind {
 public:
  enum class Border { kOpen, kClosed };
  virtual ~Wind() = default;

  virtual int cells() const = 0;   ///< per axis
  virtual float cell() const = 0;  ///< m
  /// Low corner, m.
  virtual Vec3 origin() const = 0;
  virtual Ambient& ambient() = 0;
  /// Where component `axis` of place i j k is known; of 3: the middle of the cell. m.
  Vec3 placeOf(int axis, int i, int j, int k) const;

  /// Moves the box so that `middle` lies within a cell of its middle. What is known of the air stays where it
  /// is in the world; new cells have what blows beyond.
  virtual void centreAt(const Vec3& middle) = 0;
  /// Everywhere what blows beyond.
  virtual void reset() = 0;
  /// Component `axis` of place i j k, m/s.
  using Component = std::function<float(int axis, int i, int j, int k)>;
  virtual void setComponents(const Component& value) = 0;
  /// The same by the velocity at a place in m.
  void setVelocity(const std::function<Vec3(const Vec3&)>& velocity);

  /// Solids, for the next step: none, then any number. `words`: of their ShapeData.
  virtual void clearSolids() = 0;
  virtual void addSolids(std::span<const MovingPrimitive> bodies, std::span<const uint32_t> words,
                         double seconds) = 0;

  /// Sources of wind, from now on. What spheres among them let out is there with the next project(), between
  /// walls never: there is no place for it to go.
  virtual void takeSources(std::span<const WindSource> sources) = 0;

  /// The parts of a step. `seconds`: its length.
  virtual void advect(double seconds, bool mac_cormack) = 0;
  virtual void diffuse(double seconds, double viscosity) = 0;
  /// Of momentum, with sources alone.
  virtual void exchange(double seconds) = 0;
  virtual PressureReport project() = 0;

  /// m/s, interpolated between the middles of cells, as the last project() left it.
  virtual Vec3 velocityAt(const Vec3& point) const = 0;
  /// The largest |divergence| of a cell that is not solid, beyond that of spheres of wind, times the cell:
  /// m/s.
  virtual double largestOutflow() = 0;
  /// The largest component of velocity at a face, m/s.
  virtual double fastest() const = 0;
  virtual double component(int axis, int i, int j, int k) const = 0;
  /// m^3/s, out of the box through its border.
  double flowOut() const;
};

/// What is the same on every backend.
constexpr double kResidual =
    2e-4;                        ///< of the fastest component: a fifth of what is promised of the divergence
constexpr double kStill = 1e-6;  ///< m/s, below which the residual need not go
constexpr int kMostIterations = 100;
constexpr double kLargestPart =
    0.15;                            ///< of viscosity x time / cell^2 in one explicit step; stable below 1/6
constexpr double kAirDensity = 1.2;  ///< kg/m^3
/// Of what flows out of a cell, so much goes through one of its faces at least: the residual of air that
/// spheres of wind only begin to drive.
constexpr double kLeastOfFace = 1.0 / 6;
/// Whether air of a cell gets straight to the border along an axis, past what solid(i, j, k) says of cells. A
/// sphere of wind lets no air out of others: between bodies on all sides there is no place for it to go.
template <class Solid>
bool seesBorder(int cells, int i, int j, int k, const Solid& solid) {
  for (int axis = 0; axis < 3; ++axis)
    for (const int by : {-1, 1}) {
      int at[3] = {i, j, k};
      while (at[axis] >= 0 && at[axis] < cells && !solid(at[0], at[1], at[2])) at[axis] += by;
      if (at[axis] < 0 || at[axis] == cells) return true;
    }
  return false;
}
/// Edge of a cell, m, around a groom at rest in `box`: the wind's box is twice as large.
float windCell(const Box& box, int cells);
/// Roots of Chebyshev's polynomial over the upper half of the spectrum of Jacobi's iteration, 0.5 to 2: how
/// much of it the two sweeps of a smoothing take.
constexpr double kFirstWeight = 1 / (1.25 + 0.75 * 0.70710678),
                 kSecondWeight = 1 / (1.25 - 0.75 * 0.70710678);
constexpr int kCoarsest = 4;        ///< cells per axis, of multigrid
constexpr int kCoarsestSweeps = 6;  ///< pairs

}  // namespace strandcast
