#pragma once
#include <optional>
#include <span>
#include <vector>

#include "kernels/scalar_fibre.h"

namespace strandcast {

/// Azimuthal functions of a fibre in the far field: N(cos theta, phi, sigma) of each lobe is the mean over h,
/// the place across the fibre, of its share times the azimuthal distribution about its path (Marschner et al.
/// 2003, section 4; Chiang et al. 2016). Absorption is an axis of the table, so that one table serves every
/// colour; longitudinal roughness and tilt are not in it. The factor 1 / cos^2 of Marschner's model is not in
/// N. The integral of N over phi, -pi to pi, is the lobe's albedo at that theta.
///
/// Rows are at equal steps of cos(theta): of theta_o for the model of Chiang, of theta_d = (theta_o -
/// theta_i) / 2 for that of Marschner. kernels/fibre_table.h looks values up, also in GLSL.
class FibreTable {
 public:
  static constexpr int kTexel = 16;                 ///< numbers of a texel, see FibreTexel
  static constexpr int kRows = 80, kColumns = 193;  ///< 988 KB
  /// Lobes of a lesser azimuthal roughness are narrower than the steps of a table: they are drawn as this
  /// one.
  static constexpr double kLeastRoughness = 0.1;

  /// The directions for whose light N is the mean.
  enum class Incidence {
    kDirection,
    kHalfTurn  ///< all azimuths within a quarter turn of phi: N^G of Dual Scattering, equation 25
  };

  /// `azimuthal_roughness`: 0.001 to 1; `index`: of refraction, 1 to 2.5; `rows`, `columns`: 2 or more.
  /// `bending_index`: index by which paths bend, where it is not the one of Fresnel's law.
  FibreTable(double azimuthal_roughness, double index, int rows = kRows, int columns = kColumns,
             std::optional<double> bending_index = std::nullopt, Incidence incidence = Incidence::kDirection);
  /// Of N^G, which is smooth in phi.
  static constexpr int kHalfTurnRows = 33, kHalfTurnColumns = 33;

  int rows() const { return rows_; }
  int columns() const { return columns_; }
  kernels::f64::FibreTableSize size() const {
    return {static_cast<double>(rows_), static_cast<double>(columns_), 0};
  }
  std::span<const float> numbers() const { return numbers_; }  ///< [rows][columns][kTexel]

  /// What fibreAzimuthal() makes N of, for any absorption; `phi`: -pi to pi.
  kernels::f64::FibreTexel texel(double cos_theta, double phi) const;
  /// N of each lobe; `sigma`: absorption per radius, 0 or more; `phi`: -pi to pi.
  kernels::f64::FibreLobes at(double cos_theta, double phi, double sigma) const;

 private:
  int rows_, columns_;
  std::vector<float> numbers_;
};

}  // namespace strandcast
