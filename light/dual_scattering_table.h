#pragma once
#include <vector>

#include "light/fibre_layers.h"

namespace strandcast {

/// Which paths of local multiple scattering are summed.
enum class BackscatteringSeries {
  kPaper,  ///< with one and three scatterings backward: A_1 + A_3 (Dual Scattering, eq. 14)
  kFull    ///< all
};

/// What dual scattering needs of a fibre, by inclination and absorption: table 1 of Dual Scattering without
/// N^G. One table serves all colours of a material.
class DualScatteringTable {
 public:
  /// `material`: its absorption is not used. Throws Error as checkFibreMaterial().
  DualScatteringTable(const FibreMaterial& material, BackscatteringSeries series);

  struct Values {
    double forward = 0;           ///< a_f: share of light that goes forward, 0 to 1
    double forward_variance = 0;  ///< beta_f^2, rad^2
    Backscattering back;          ///< A_b, Delta_b, sigma_b^2
  };
  /// `cosine`: of the inclination, 0 to 1; `absorption`: per radius, 0 or more. Bilinear.
  Values at(double cosine, double absorption) const;

  static constexpr int kRows = 33, kColumns = 65;
  /// Place of an absorption among the columns, 0 to 1: r / (1 + r) with r the square root of the absorption,
  /// because A_b falls with that root where little is absorbed.
  static double columnOf(double absorption);

 private:
  static constexpr int kNumbers = 5;

  /// kRows at equal steps of the inclination's cosine; kColumns at equal steps of columnOf(); kNumbers: a_f,
  /// beta_f^2, A_b, Delta_b, sigma_b^2.
  std::vector<float> numbers_;
};

}  // namespace strandcast
