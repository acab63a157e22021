#pragma once
#include <span>
#include <vector>

#include "core/parameters.h"

namespace strandcast {

/// What blows into the wind grid: `wind`, stronger and weaker in gusts, with turbulence that it carries along
/// (Taylor's frozen turbulence). The same seed gives the same wind on every machine.
///
/// Gusts: the speed is wind (1 + gust s(t)), s a sum of 8 harmonics of gust_period with random phases and
/// amplitudes as n^(-5/6), so that power goes with frequency^(-5/3), rms 1 (Kolmogorov's inertial range).
/// Turbulence: a periodic box of edge turbulence_length, sum of 96 solenoidal Fourier modes (Kraichnan 1970)
/// with whole wave numbers 1 <= |n| < 8 and energy E(n) as n^(-5/3); mean square of the components
/// (turbulence |wind|)^2. Its axes are not the world's: turnedToBox() of kernels/grid.h.
class Ambient {
 public:
  /// How far it has come, summed up step by step, so that other settings move neither eddies nor gusts.
  struct Progress {
    Eigen::Vector3d carried = Eigen::Vector3d::Zero();  ///< boxes of turbulence, each 0 to 1: it is periodic
    double gust = 0;                                    ///< periods of the slowest gust, 0 to 1
  };

  Ambient();
  /// Takes the settings; makes a new box where the seed is another.
  void configure(const Parameters& parameters);
  void advance(double seconds);
  const Progress& progress() const { return progress_; }
  void setProgress(const Progress& progress);
  /// Places are told from `way` (m) farther on from now on: the eddies stay where they are.
  void moveOrigin(const Vec3& way);

  /// m/s without turbulence.
  const Vec3& mean() const { return mean_; }
  /// m/s at a point in metres.
  Vec3 at(const Vec3& point) const;
  // What a GPU needs to do the same as at().
  int seed() const { return seed_; }
  float turbulence() const { return turbulence_; }  ///< m/s
  const Vec3& carried() const { return carried_; }  ///< m, in the axes of the box: where that has its corner
  float boxPlacesPerMetre() const;
  /// 32^3 places, x fastest. The square of a component of what they hold is 1 in the mean.
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
