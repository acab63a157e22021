#pragma once
#include <Eigen/Core>

#include <array>

namespace strandcast {

/// A diffuse surface under a rough dielectric coat: skin, and with index 1 a bare diffuse one. The coat
/// reflects by the microfacets of Walter et al. 2007 (GGX, visible normals drawn after Heitz 2018). What it
/// does not reflect in a direction, by its directional albedo, passes to the base, which scatters it with all
/// internal reflections (Kelemen and Szirmay-Kalos 2001). A white surface reflects all light.
///
/// Frame: z is the normal. Directions are unit vectors that point away from the surface.
class CoatedDiffuse {
 public:
  struct Sample {
    Eigen::Vector3d wi;
    double pdf = 0;  ///< per solid angle; 0 if there is no sample
    Eigen::Array3d f{0, 0, 0};
  };

  /// `albedo`: linear, 0 to 1. `index`: of refraction, 1 to 2.5; 1 is no coat. `roughness`: GGX alpha, 0.01
  /// to 1. Throws Error on other values.
  CoatedDiffuse(const Eigen::Array3d& albedo, double index, double roughness);

  /// 1/sr, without cosine; 0 unless both directions are above the surface.
  Eigen::Array3d f(const Eigen::Vector3d& wo, const Eigen::Vector3d& wi) const;
  double pdf(const Eigen::Vector3d& wo, const Eigen::Vector3d& wi) const;
  /// `u0` chooses coat or base, `u1` and `u2` the direction; uniform in [0, 1).
  Sample sample(const Eigen::Vector3d& wo, double u0, double u1, double u2) const;

 private:
  static constexpr int kAlbedos = 64;

  double coatAlbedo(double cosine) const;
  double coatShare(double cosine) const;

  Eigen::Array3d base_;  ///< diffuse reflectance of the base with internal reflections, over pi
  double index_, alpha_;
  std::array<double, kAlbedos + 1> albedos_{};  ///< of the coat, at equal parts of the cosine from 0 to 1
};

}  // namespace strandcast
