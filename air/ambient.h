#pragma once
#include <span>
#include <vector>

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
  void findMean();

  Vec3 wind_ = Vec3::Zero(), mean_ = Vec3::Zero(), carried_ = Vec3::Zero();
  float gust_ = 0, gust_period_ = 1, turbulence_ = 0, turbulence_length_ = 1;
  int seed_ = -1;
  Progress progress_;
  std::vector<float> gust_phases_;
  std::vector<Vec3> box_;
};

}  // namespace strandcast
