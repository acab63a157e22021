// Interface of the wind grids of all backends; the ambient wind, and the box of a grid.
#pragma once
#include <functional>
#include <span>
#include <vector>

#include "air/wind_source.h"
#include "core/contact_primitive.h"
#include "core/geometry.h"
#include "core/parameters.h"

namespace strandcast {

/// The ambient wind, which flows into the wind grid: the parameter `wind`, modulated by gusts, with
/// turbulence that the mean wind advects (Taylor's frozen turbulence). The same seed gives the same wind on
/// every machine.
///
/// Gusts: the speed is wind (1 + gust s(t)), s the sum of 8 harmonics of gust_period with random phases
/// and amplitudes proportional to n^(-5/6). Power is proportional to frequency^(-5/3) (Kolmogorov's inertial
/// range); the rms of s is 1.
/// Turbulence: a periodic box of edge turbulence_length, the sum of 96 solenoidal Fourier modes (Kraichnan
/// 1970) with integer wave vectors 1 <= |n| < 8 and energy E(n) proportional to n^(-5/3). The mean square of
/// a component is (turbulence |wind|)^2. The box is rotated against the world's axes: toTurbulenceBox() in
/// kernels/grid.h.
class Ambient {
 public:
  /// Phases of turbulence and gusts, accumulated step by step: a change of settings moves neither eddies nor
  /// gusts.
  struct Progress {
    Eigen::Vector3d carried = Eigen::Vector3d::Zero();  ///< advection in box lengths, per axis in [0, 1)
    double gust = 0;                                    ///< phase in periods of the slowest gust, in [0, 1)
  };

  Ambient();
  /// Takes the settings. Makes a new box of turbulence when wind_seed differs.
  void configure(const Parameters& parameters);
  /// Advances gusts and turbulence by `seconds`.
  void advance(double seconds);
  const Progress& progress() const { return progress_; }
  void setProgress(const Progress& progress);
  /// Origin rebasing: moves the origin of positions by `way` (m). Eddies keep their place in the world.
  void moveOrigin(const Vec3& way);

  /// m/s, wind with gusts, without turbulence.
  const Vec3& mean() const { return mean_; }
  /// m/s, with turbulence, at a point in metres from the origin.
  Vec3 at(const Vec3& point) const;
  // Inputs of the shaders that compute at().
  int seed() const { return seed_; }
  float turbulence() const { return turbulence_; }  ///< m/s, rms of a component
  /// Position of the box's corner, m, along the axes of the box.
  const Vec3& carried() const { return carried_; }
  /// Samples of box() per metre.
  float boxPlacesPerMetre() const;
  /// 32^3 velocities, x fastest, normalised: the mean square of a component is 1.
  std::span<const Vec3> box() const { return box_; }

 private:
  void makeBox(uint64_t seed);
  void computeMean();

  Vec3 wind_ = Vec3::Zero(), mean_ = Vec3::Zero(), carried_ = Vec3::Zero();
  float gust_ = 0, gust_period_ = 1, turbulence_ = 0, turbulence_length_ = 1;
  int seed_ = -1;
  Progress progress_;
  std::vector<float> gust_phases_;
  std::vector<Vec3> box_;
};

/// Placement of a wind grid: an axis-aligned box that moves by whole cells.
class WindBox {
 public:
  WindBox(int cells, float cell) : cells_(cells), cell_(cell) {}

  Vec3 corner() const { return corner_.cast<float>(); }  ///< low corner, m from the origin
  /// Moves the box so that `middle` (m) is within a cell of the box's centre. Returns the shift in cells.
  Eigen::Vector3i centreAt(const Vec3& middle);
  /// Origin rebasing: moves the origin of positions by `way` (m). The box keeps its place in the world, which
  /// then need not be a whole number of cells from the origin.
  void moveOrigin(const Vec3& way) { corner_ -= way.cast<double>(); }

 private:
  int cells_;
  float cell_;
  /// Low corner, m. Double, so that whole cells and whole metres add up without rounding.
  Eigen::Vector3d corner_ = Eigen::Vector3d::Zero();
};

/// Result of a pressure solve.
struct PressureReport {
  int iterations = 0;
  double residual = 0;  ///< largest residual of a cell, m/s (divergence x cell)
};

/// Air in a box of cubic cells, staggered, incompressible: one step is advection, viscosity, exchange of
/// momentum (hair, sources), projection (Stam 1999; Bridson 2015, "Fluid Simulation for Computer Graphics").
/// Border kOpen: the pressure at the border is 0 and the inflow is the ambient wind. kClosed: walls without
/// friction. The box is aligned with the world's axes and moves by whole cells. Interface of the wind of
/// every backend.
class Wind {
 public:
  enum class Border { kOpen, kClosed };
  virtual ~Wind() = default;

  virtual int cells() const = 0;   ///< per axis
  virtual float cell() const = 0;  ///< m
  /// Low corner of the box, m.
  virtual Vec3 origin() const = 0;
  virtual Ambient& ambient() = 0;
  /// Position of component `axis` (0 to 2: a face centre; 3: the cell centre) of index i j k, m.
  Vec3 placeOf(int axis, int i, int j, int k) const;

  /// Moves the box by whole cells so that `middle` (m) is within a cell of its centre. The air keeps its
  /// place in the world; new cells get the ambient wind.
  virtual void centreAt(const Vec3& middle) = 0;
  /// Sets the ambient wind everywhere (kOpen) and the pressure to 0.
  virtual void reset() = 0;
  /// Returns component `axis` of the face with index i j k, m/s.
  using Component = std::function<float(int axis, int i, int j, int k)>;
  virtual void setComponents(const Component& value) = 0;
  /// The same from a velocity field (m/s) over positions (m).
  void setVelocity(const std::function<Vec3(const Vec3&)>& velocity);

  /// Solids of the next step: clearSolids(), then addSolids() any number of times. `words`: ShapeData::words
  /// of the bodies. `seconds`: length of the step, for the velocities of the bodies.
  virtual void clearSolids() = 0;
  virtual void addSolids(std::span<const MovingPrimitive> bodies, std::span<const uint32_t> words,
                         double seconds) = 0;

  /// Replaces all wind sources. Spheres take effect with the next project(). With kClosed they have no
  /// effect: the air would have no outlet.
  virtual void setSources(std::span<const WindSource> sources) = 0;

  /// Stages of a step, in this order. `seconds`: length of the step; `viscosity`: m^2/s.
  virtual void advect(double seconds, bool mac_cormack) = 0;
  virtual void diffuse(double seconds, double viscosity) = 0;
  /// Exchange of momentum with sources, without hair.
  virtual void exchange(double seconds) = 0;
  virtual PressureReport project() = 0;

  /// m/s, interpolated between cell centres, after the last project().
  virtual Vec3 velocityAt(const Vec3& point) const = 0;
  /// Largest |divergence - target divergence| x cell of all cells that are not solid, m/s.
  virtual double largestOutflow() = 0;
  /// Largest absolute component of velocity of a face, m/s.
  virtual double fastest() const = 0;
  /// Component `axis` of the face with index i j k, m/s.
  virtual double component(int axis, int i, int j, int k) const = 0;
  /// Outflow through the border of the box, m^3/s.
  double flowOut() const;
};

/// Constants shared by all backends.
constexpr double kResidual = 2e-4;  ///< tolerance of the residual over the fastest component; a fifth of the
                                    ///< promised bound of the divergence
constexpr double kStill = 1e-6;     ///< m/s, lower bound of the tolerance
constexpr int kMaxPressureIterations = 100;
constexpr double kLargestPart =
    0.15;  ///< largest viscosity x time / cell^2 of an explicit step; stable below 1/6
constexpr double kAirDensity = 1.2;  ///< kg/m^3
/// At least this fraction of the outflow of a cell passes through one of its six faces. The tolerance uses it
/// as an estimate of the velocity when spheres begin to drive still air.
constexpr double kMinFaceShare = 1.0 / 6;
/// Whether a straight line along an axis leads from a cell to the border without a solid cell. `solid(i, j,
/// k)`: whether a cell is solid. Sphere sources emit from such cells only: enclosed air has no outlet.
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
/// Edge of a cell, m, for a groom with the bounds `box` at rest. The wind's box has twice the largest edge of
/// `box`.
float windCell(const Box& box, int cells);
/// Weights of the two Jacobi sweeps of a smoothing: inverse roots of the Chebyshev polynomial over 0.5 to 2,
/// the upper part of the spectrum of the Jacobi iteration.
constexpr double kFirstWeight = 1 / (1.25 + 0.75 * 0.70710678),
                 kSecondWeight = 1 / (1.25 - 0.75 * 0.70710678);
constexpr int kCoarsest = 4;        ///< cells per axis of the coarsest multigrid level
constexpr int kCoarsestSweeps = 6;  ///< pairs of sweeps there

}  // namespace strandcast
