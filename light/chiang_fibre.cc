#include "light/chiang_fibre.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "light/fibre_direction.h"

namespace strandcast {
namespace {

using kernels::f64::FibreLobes;
using kernels::f64::FibreRay;
using kernels::f64::FibreShape;

FibreRay rayOf(const FibreShape& shape, const FibreDirection& o, double h) {
  return kernels::f64::fibreRay(o.sine, o.cosine, std::clamp(h, -1.0, 1.0), shape.index);
}

std::array<FibreLobes, 3> sharesOf(const FibreMaterial& material, const FibreRay& ray) {
  std::array<FibreLobes, 3> shares;
  for (int c = 0; c < 3; ++c)
    shares[static_cast<size_t>(c)] =
        kernels::f64::fibreShares(ray.fresnel, std::exp(-material.sigma_a[c] * ray.passage));
  return shares;
}

/// Mean of the channels: the shares by which lobes are drawn.
FibreLobes meanOf(const std::array<FibreLobes, 3>& s) {
  return {(s[0].r + s[1].r + s[2].r) / 3, (s[0].tt + s[1].tt + s[2].tt) / 3,
          (s[0].trt + s[1].trt + s[2].trt) / 3, (s[0].residual + s[1].residual + s[2].residual) / 3};
}
double totalOf(const FibreLobes& lobes) { return lobes.r + lobes.tt + lobes.trt + lobes.residual; }

Eigen::Array3d valueOf(const std::array<FibreLobes, 3>& shares, const FibreLobes& densities, double cos_i) {
  return Eigen::Array3d(fibreSum(shares[0], densities), fibreSum(shares[1], densities),
                        fibreSum(shares[2], densities)) /
         std::max(cos_i, kLeastCosine);
}

/// Samples longitudinalFunction() for a theta_o that tilt has changed (d'Eon et al. 2013, "Importance
/// Sampling for Physically-Based Hair Fiber Models", section 3). 1 - cosine of the angle to the lobe's axis
/// is computed directly, which is exact where the variance is small; at u1 = 0 the logarithm is bounded.
void sampleInclination(double sin_o, double cos_o, double variance, double u1, double u2, double& sin_i,
                       double& cos_i) {
  const double tail = std::exp(-2 / variance);
  const double off = std::clamp(-variance * std::log(std::max(u1 + (1 - u1) * tail, 1e-300)), 0.0, 2.0);
  const double radial = std::sqrt(off * (2 - off)), angle = 2 * std::numbers::pi * u2;
  const double along = 1 - off, aside = radial * std::cos(angle);
  sin_i = std::clamp(-along * sin_o + aside * cos_o, -1.0, 1.0);
  cos_i = std::hypot(along * cos_o + aside * sin_o, radial * std::sin(angle));
}

/// The lobe that u, 0 to 1, chooses by its share; -1 if all shares are 0.
int chosenLobe(const FibreLobes& shares, double u) {
  const std::array<double, 4> list{shares.r, shares.tt, shares.trt, shares.residual};
  double left = u * totalOf(shares);
  int chosen = -1;
  for (int p = 0; p < 4; ++p) {
    const double share = list[static_cast<size_t>(p)];
    if (!(share > 0)) continue;
    chosen = p;
    if (left < share) break;
    left -= share;
  }
  return chosen;
}

}  // namespace

ChiangFibre::ChiangFibre(const FibreMaterial& material)
    : material_(material), shape_(fibreShapeOf(material)) {}

ChiangFibre ChiangFibre::withAbsorption(const Eigen::Array3d& sigma_a) const {
  ChiangFibre fibre = *this;
  fibre.material_.sigma_a = sigma_a;
  return fibre;
}

Eigen::Array3d ChiangFibre::f(const Eigen::Vector3d& wo, const Eigen::Vector3d& wi, double h) const {
  return evaluate(wo, wi, h).f;
}

double ChiangFibre::pdf(const Eigen::Vector3d& wo, const Eigen::Vector3d& wi, double h) const {
  return evaluate(wo, wi, h).pdf;
}

ChiangFibre::Sample ChiangFibre::evaluate(const Eigen::Vector3d& wo, const Eigen::Vector3d& wi,
                                          double h) const {
  const FibreDirection o(wo), i(wi);
  const FibreRay ray = rayOf(shape_, o, h);
  const std::array<FibreLobes, 3> shares = sharesOf(material_, ray);
  const FibreLobes mean = meanOf(shares);
  const double total = totalOf(mean);
  if (!(total > 0)) return {wi, 0, {0, 0, 0}};
  const FibreLobes densities =
      fibreDensities(shape_, ray, o.sine, o.cosine, i.sine, i.cosine, azimuthBetween(o, i));
  return {wi, fibreSum(mean, densities) / total, valueOf(shares, densities, i.cosine)};
}

ChiangFibre::Sample ChiangFibre::sample(const Eigen::Vector3d& wo, double h, double u0, double u1, double u2,
                                        double u3) const {
  const FibreDirection o(wo);
  const FibreRay ray = rayOf(shape_, o, h);
  const std::array<FibreLobes, 3> shares = sharesOf(material_, ray);
  const FibreLobes mean = meanOf(shares);
  const int p = chosenLobe(mean, u0);
  if (p < 0) return {Eigen::Vector3d(-wo), 0, {0, 0, 0}};

  // Tilt theta_o for the lobe that was drawn.
  double sin_o = o.sine, cos_o = o.cosine;
  if (p < 3) {
    const std::array<double, 3> sines{shape_.tilt_sin.x, shape_.tilt_sin.y, shape_.tilt_sin.z},
        cosines{shape_.tilt_cos.x, shape_.tilt_cos.y, shape_.tilt_cos.z};
    const auto lobe = static_cast<size_t>(p);
    sin_o = o.sine * cosines[lobe] + o.cosine * sines[lobe];
    cos_o = std::abs(o.cosine * cosines[lobe] - o.sine * sines[lobe]);
  }
  double sin_i = 0, cos_i = 0;
  sampleInclination(sin_o, cos_o, lobeVariance(shape_, p), u1, u2, sin_i, cos_i);

  // Draw phi = phi_o - phi_i, and rotate wo's azimuth by -phi.
  const double phi = p < 3
                         ? kernels::f64::wrappedAngle(kernels::f64::fibreAzimuth(ray, p) +
                                                      kernels::f64::trimmedLogisticQuantile(u3, shape_.scale))
                         : std::numbers::pi * (2 * u3 - 1);
  const double c = std::cos(phi), s = std::sin(phi);
  const Eigen::Vector3d wi(sin_i, cos_i * (o.y * c + o.z * s), cos_i * (o.z * c - o.y * s));

  const FibreLobes densities = fibreDensities(shape_, ray, o.sine, o.cosine, sin_i, cos_i, phi);
  return {wi, fibreSum(mean, densities) / totalOf(mean), valueOf(shares, densities, cos_i)};
}

}  // namespace strandcast
