#pragma once
#include <Eigen/Core>
#include <memory>

#include "light/fibre_material.h"
#include "light/fibre_table.h"

namespace strandcast {

/// Far field of ChiangFibre: the mean of its f over h, by a table of the azimuthal functions. Same frame and
/// conventions. Immutable; const functions may be called from many threads.
class FarChiangFibre {
 public:
  /// Builds the table. Throws Error as checkFibreMaterial().
  explicit FarChiangFibre(const FibreMaterial& material);
  /// Takes a table that was built for the azimuthal roughness and the index of `material`.
  FarChiangFibre(const FibreMaterial& material, std::shared_ptr<const FibreTable> table);

  /// 1/sr, per channel, without cosine.
  Eigen::Array3d f(const Eigen::Vector3d& wo, const Eigen::Vector3d& wi) const;
  const FibreTable& table() const { return *table_; }

 private:
  FibreMaterial material_;
  kernels::f64::FibreShape shape_;
  std::shared_ptr<const FibreTable> table_;
};

/// Shifts alpha and widths beta of Marschner's lobes that belong to a material. alpha_R = -tilt, alpha_TT =
/// -alpha_R / 2, alpha_TRT = -3 alpha_R / 2: for a tilt of 0.09 to 0.17 rad what Marschner et al. measured.
/// The widths are those of Chiang's roughness, beta_TT = beta_R / 2 and beta_TRT = 2 beta_R.
kernels::f64::MarschnerLobes marschnerLobes(const FibreMaterial& material);

/// Far field of Marschner et al. 2003: R, TT and TRT with Gaussian longitudinal functions, S = sum M N /
/// cos^2 theta_d. It is reciprocal. It does not conserve energy: longer paths are left out, and Gaussians
/// lose light near the fibre's axis. M integrates to 1 over theta_i (the paper's M, over theta_h, is twice
/// that). N is convolved with Chiang's azimuthal roughness, so that the paper's treatment of caustics is not
/// needed.
///
/// `axis_ratio` below 1: y of the frame is the major axis of the section; TRT bends by the index of the
/// paper's section 5.2.3, clamped to 1 to 2.5. An approximation for ratios of 0.85 and more: docs/light.md
/// has its errors.
class MarschnerFibre {
 public:
  /// Throws Error as checkFibreMaterial().
  explicit MarschnerFibre(const FibreMaterial& material);
  /// With other shifts (-pi / 2 to pi / 2) and widths (1e-4 to 10), rad. Throws Error where they are not
  /// that.
  MarschnerFibre(const FibreMaterial& material, const kernels::f64::MarschnerLobes& lobes);

  /// S, 1/sr, per channel, without cosine.
  Eigen::Array3d f(const Eigen::Vector3d& wo, const Eigen::Vector3d& wi) const;
  /// Tables of the kernel: a round one; for an elliptic section five more of TRT, behind it.
  std::span<const float> numbers() const { return numbers_; }
  kernels::f64::FibreTableSize size() const { return size_; }
  const kernels::f64::MarschnerLobes& lobes() const { return lobes_; }

 private:
  FibreMaterial material_;
  kernels::f64::MarschnerLobes lobes_;
  kernels::f64::FibreTableSize size_;
  std::vector<float> numbers_;
};

}  // namespace strandcast
