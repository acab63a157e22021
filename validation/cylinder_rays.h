#pragma once
#include <array>
#include <vector>

namespace strandcast {

/// Geometric optics of a smooth dielectric cylinder: rays are traced through it in three dimensions, with
/// Snell's and Fresnel's laws for unpolarised light. Independent of light/ and its kernels.
struct CylinderOptics {
  double index = 1.55;  ///< of refraction
  double sigma_a = 0;   ///< absorption per radius, or per major half axis
  /// Half axis of the section along z over that along y, which is 1.
  double axis_ratio = 1;
  /// Azimuth that the light comes from, rad, from y towards z.
  double azimuth = 0;
};

/// Where the light of rays at one inclination goes, per number of passages through the interior.
struct ScatteredRays {
  static constexpr int kBins = 3600;
  std::array<double, 3> albedo{};  ///< shares of R, TT, TRT in the incoming light
  double rest = 0;                 ///< share that is still inside after two reflections there
  /// Share in each bin of phi_o - phi_i, from -pi to pi, of R, TT, TRT.
  std::array<std::vector<double>, 3> histogram;
};

/// Traces `rays`, at random within equal strata across the cylinder, at the inclination `theta`, rad.
ScatteredRays traceCylinder(const CylinderOptics& cylinder, double theta, int rays, unsigned seed);

/// Density per radian at phi of a histogram whose rays are deflected at random by the logistic distribution
/// of scale s, trimmed to -pi to pi.
double roughenedDensity(const std::vector<double>& histogram, double s, double phi);

}  // namespace strandcast
