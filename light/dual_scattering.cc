#include "light/dual_scattering.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

namespace strandcast {

using Eigen::Array3d, Eigen::Vector3d;

void ForwardPath::pass(const Array3d& forward, const Array3d& variance) {
  direct_ = 0;
  left_ *= forward;
  variance_ += variance;
}

void ForwardPath::passMany(double depth, const Array3d& forward, const Array3d& variance) {
  direct_ *= std::exp(-depth);
  left_ *= (-depth * (1 - forward)).exp();
  passed_ += depth * forward;
  spread_ += depth * forward * variance;
}

ForwardScattering ForwardPath::light() const {
  // Of the light that many hairs pass on, a Poisson number of mean `passed_` has been met. The share with
  // none is the direct light; the rest has all of the spread.
  const Array3d scattered = direct_ > 0 ? Array3d(1 - (-passed_).exp()) : Array3d(1, 1, 1);
  return {direct_, left_, variance_ + (scattered > 1e-9).select(spread_ / scattered.max(1e-9), 0)};
}

DualScattering::DualScattering(const FibreMaterial& material, BackscatteringSeries series)
    : shape_(fibreShapeOf(material)),
      direct_(material.azimuthal_roughness, material.index),
      half_turn_(material.azimuthal_roughness, material.index, FibreTable::kHalfTurnRows,
                 FibreTable::kHalfTurnColumns, std::nullopt, FibreTable::Incidence::kHalfTurn),
      layers_(material, series) {}

DualScattering::Shading DualScattering::shade(const Vector3d& tangent, const Vector3d& to_eye,
                                              const Vector3d& to_light, const Array3d& absorption,
                                              const ForwardScattering& light,
                                              const HairDensity& density) const {
  const double sin_o = std::clamp(tangent.dot(to_eye), -1.0, 1.0),
               sin_i = std::clamp(tangent.dot(to_light), -1.0, 1.0);
  const double cos_o = std::sqrt(1 - sin_o * sin_o), cos_i = std::sqrt(1 - sin_i * sin_i);
  const Vector3d eye = to_eye - sin_o * tangent, lamp = to_light - sin_i * tangent;
  const double phi = kernels::f64::fibreAtan(tangent.dot(lamp.cross(eye)), lamp.dot(eye));
  const double cosine = std::sqrt(kernels::f64::cosineOfDifference2(sin_o, cos_o, sin_i, cos_i));
  const kernels::f64::FibreTexel direct = direct_.texel(cos_o, phi), half_turn = half_turn_.texel(cos_o, phi);
  Shading out;
  for (Eigen::Index c = 0; c < 3; ++c) {
    const DualScatteringTable::Values layer = layers_.at(cosine, absorption[c]);
    const kernels::f64::DualParts parts = kernels::f64::dualScattering(
        shape_, kernels::f64::fibreAzimuthal(direct, absorption[c]),
        kernels::f64::fibreAzimuthal(half_turn, absorption[c]),
        {layer.back.attenuation * density.backward, layer.back.shift, layer.back.variance},
        {light.direct, (light.transmittance[c] - light.direct) * density.forward, light.variance[c]}, sin_o,
        cos_o, sin_i, cos_i);
    out.single[c] = parts.single;
    out.global[c] = parts.global;
    out.local[c] = parts.local;
  }
  return out;
}

}  // namespace strandcast
