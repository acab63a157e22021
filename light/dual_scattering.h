#pragma once
#include <Eigen/Core>
#include <array>

#include "light/dual_scattering_table.h"
#include "light/fibre_table.h"

namespace strandcast {

/// Light that reaches a point through hair, of three colours.
struct ForwardScattering {
  double direct = 1;                      ///< share that no hair has met, 0 to 1
  Eigen::Array3d transmittance{1, 1, 1};  ///< T_f without density factor: of direct and scattered light
  Eigen::Array3d variance{0, 0, 0};       ///< sigma_f^2 of the scattered light, rad^2
};

/// Shares of the directions around a fibre that hair closes, 0 to 1 (Dual Scattering, figure 4).
struct HairDensity {
  double forward = 0.7, backward = 0.7;  ///< d_f: on the side of the light; d_b: on the other side
};

/// Adds up the hairs that light meets.
class ForwardPath {
 public:
  /// One hair: `forward`: a_f; `variance`: beta_f^2, rad^2 (eq. 5 and 8).
  void pass(const Eigen::Array3d& forward, const Eigen::Array3d& variance);
  /// Hairs that lie as by chance, on average `depth`. At an optical depth tau, e^-tau of all rays meet none,
  /// and e^(-tau (1 - a_f)) of the light is left.
  void passMany(double depth, const Eigen::Array3d& forward, const Eigen::Array3d& variance);
  ForwardScattering light() const;

 private:
  double direct_ = 1;
  Eigen::Array3d left_{1, 1, 1}, variance_{0, 0, 0};  ///< of single hairs
  Eigen::Array3d passed_{0, 0, 0}, spread_{0, 0, 0};  ///< of many
};

/// Shading of a fibre by dual scattering (Zinke, Yuksel, Weber, Keyser 2008), with the lobes of ChiangFibre.
/// Immutable.
class DualScattering {
 public:
  /// `material`: its absorption is not used. Throws Error as checkFibreMaterial().
  DualScattering(const FibreMaterial& material, BackscatteringSeries series);

  const DualScatteringTable& layers() const { return layers_; }

  /// The parts of what a fibre sends to the eye, over the light's irradiance perpendicular to its direction.
  struct Shading {
    Eigen::Array3d single{0, 0, 0};  ///< scattered by this fibre alone
    Eigen::Array3d global{0, 0, 0};  ///< by hairs towards the light before
    Eigen::Array3d local{0, 0, 0};   ///< by the hair around the fibre, of direct and of scattered light
    Eigen::Array3d sum() const { return single + global + local; }
  };
  /// `tangent`: unit, towards the tip; `to_eye`, `to_light`: unit; `absorption`: per radius. Equation 22,
  /// with the cosine of the light's inclination.
  Shading shade(const Eigen::Vector3d& tangent, const Eigen::Vector3d& to_eye,
                const Eigen::Vector3d& to_light, const Eigen::Array3d& absorption,
                const ForwardScattering& light, const HairDensity& density) const;

 private:
  kernels::f64::FibreShape shape_;
  FibreTable direct_, half_turn_;
  DualScatteringTable layers_;
};

}  // namespace strandcast
