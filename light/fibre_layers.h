#pragma once
#include <array>
#include <span>
#include <vector>

#include "kernels/scalar_fibre.h"
#include "light/fibre_material.h"
#include "light/fibre_stack.h"

namespace strandcast {

/// What fibres of a material do to light that comes from half of the specular cone alike, averaged over
/// azimuth and over the width of the fibre: forward is all that goes on into the other half (Dual Scattering,
/// eq. 6 and 12). By the lobes of ChiangFibre.
class FibreLayers {
 public:
  /// The material's absorption is not used. Throws Error as checkFibreMaterial().
  explicit FibreLayers(const FibreMaterial& material);

  /// `sine`: of the light's inclination, -1 to 1; `absorptions`: per radius, 0 or more, may be infinite. One
  /// result for each.
  std::vector<LayerScattering> at(double sine, std::span<const double> absorptions) const;
  LayerScattering at(double sine, double absorption) const { return at(sine, {&absorption, 1})[0]; }

 private:
  double forwardShare(double azimuth) const;
  /// Of the lobes R, TT, TRT and longer paths: shares of light, and of these what goes forward.
  LayerScattering layerOf(const std::array<double, 4>& forward, const std::array<double, 4>& whole) const;

  kernels::f64::FibreShape shape_;
  double tilt_;
  std::vector<double> forward_;  ///< share of light that goes forward of a path's azimuth, 0 to pi
};

}  // namespace strandcast
