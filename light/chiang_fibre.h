#pragma once
#include <Eigen/Core>

#include "kernels/scalar_fibre.h"
#include "light/fibre_material.h"

namespace strandcast {

/// Near-field scattering of a fibre after Chiang et al. 2016, "A Practical and Controllable Hair and Fur
/// Model for Production Path Tracing": lobes R, TT, TRT and a residual one for all longer paths, with the
/// longitudinal function of d'Eon et al. 2011. Without absorption the fibre returns all light: the integral
/// of f cos(theta_i) over all wi is 1 for every wo and h.
///
/// Frame: x is the tangent towards the tip. Directions are unit vectors that point away from the fibre: wo to
/// the viewer, wi to the light. theta = asin(w.x) is measured from the normal plane. f has no cosine: a
/// direction of the light contributes f L cos(theta_i), with cos(theta_i) = length of (wi.y, wi.z).
///
/// `h`, -1 to 1, is where the ray along wo meets the fibre, across it: the component of the surface normal
/// there along x cross wo, normalised. It is the sine of the normal's azimuth minus wo's.
///
/// Immutable; const functions may be called from many threads.
class ChiangFibre {
 public:
  struct Sample {
    Eigen::Vector3d wi;
    double pdf = 0;  ///< per solid angle; 0 if there is no sample, and then f is 0
    Eigen::Array3d f{0, 0, 0};
  };

  /// Throws Error as checkFibreMaterial().
  explicit ChiangFibre(const FibreMaterial& material);

  /// The same fibre of another absorption per radius, 0 or more and finite, which is not checked.
  ChiangFibre withAbsorption(const Eigen::Array3d& sigma_a) const;

  /// 1/sr, per channel.
  Eigen::Array3d f(const Eigen::Vector3d& wo, const Eigen::Vector3d& wi, double h) const;
  /// Density per solid angle by which sample() chooses wi.
  double pdf(const Eigen::Vector3d& wo, const Eigen::Vector3d& wi, double h) const;
  /// f and pdf of one pair of directions, in little more time than either.
  Sample evaluate(const Eigen::Vector3d& wo, const Eigen::Vector3d& wi, double h) const;
  /// Draws wi by four independent uniform numbers, 0 to 1: u0 chooses the lobe, u1 and u2 its inclination, u3
  /// its azimuth. f cos(theta_i) / pdf is bounded by the largest ratio of the channels' albedos.
  Sample sample(const Eigen::Vector3d& wo, double h, double u0, double u1, double u2, double u3) const;

  const FibreMaterial& material() const { return material_; }

 private:
  FibreMaterial material_;
  kernels::f64::FibreShape shape_;
};

}  // namespace strandcast
