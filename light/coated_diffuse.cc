#include "light/coated_diffuse.h"

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "kernels/scalar_fibre.h"

namespace strandcast {
namespace {

/// fresnelReflectance(), also of cosines that rounding has left outside of 0 to 1.
double coatFresnel(double cosine, double index) {
  return kernels::f64::fresnelReflectance(std::clamp(cosine, 0.0, 1.0), index);
}

/// GGX distribution of microfacet normals (Walter et al. 2007, equation 33), and its masking of one direction
/// (equation 34).
double ggxDensity(double cosine, double alpha) {
  const double d = cosine * cosine * (alpha * alpha - 1) + 1;
  return alpha * alpha / (std::numbers::pi * d * d);
}
double ggxMasking(double cosine, double alpha) {
  const double c2 = cosine * cosine;
  return 2 / (1 + std::sqrt(1 + alpha * alpha * (1 - c2) / std::max(c2, 1e-12)));
}

/// A normal among those that `w` sees (Heitz 2018, "Sampling the GGX Distribution of Visible Normals").
Eigen::Vector3d visibleNormal(const Eigen::Vector3d& w, double alpha, double u1, double u2) {
  const Eigen::Vector3d view = Eigen::Vector3d(alpha * w.x(), alpha * w.y(), w.z()).normalized();
  const double across = view.x() * view.x() + view.y() * view.y();
  const Eigen::Vector3d t1 = across > 1e-14 ? Eigen::Vector3d(-view.y(), view.x(), 0) / std::sqrt(across)
                                            : Eigen::Vector3d::UnitX().eval();
  const Eigen::Vector3d t2 = view.cross(t1);
  const double r = std::sqrt(u1), phi = 2 * std::numbers::pi * u2, s = (1 + view.z()) / 2;
  const double a = r * std::cos(phi), b = (1 - s) * std::sqrt(1 - a * a) + s * r * std::sin(phi);
  const Eigen::Vector3d n = a * t1 + b * t2 + std::sqrt(std::max(1 - a * a - b * b, 0.0)) * view;
  return Eigen::Vector3d(alpha * n.x(), alpha * n.y(), std::max(n.z(), 1e-9)).normalized();
}

/// Directional albedo of the microfacets, by stratified visible normals.
double ggxAlbedo(double cosine, double index, double alpha) {
  constexpr int kStrata = 24;
  const Eigen::Vector3d w(std::sqrt(1 - cosine * cosine), 0, cosine);
  double sum = 0;
  for (int i = 0; i < kStrata * kStrata; ++i) {
    const double u1 = (i % kStrata + 0.5) / kStrata, u2 = (i / kStrata + 0.5) / kStrata;  // NOLINT
    const Eigen::Vector3d half = visibleNormal(w, alpha, u1, u2);
    const double out = 2 * w.dot(half) * half.z() - w.z();
    if (out > 0) sum += coatFresnel(w.dot(half), index) * ggxMasking(out, alpha);
  }
  return sum / (kStrata * kStrata);
}

void checkCoat(bool is_valid, const char* what, double value, const char* range) {
  if (!is_valid) throw Error(fmt::format("the {} is {:g}", what, value), "material of a surface", range);
}

}  // namespace

CoatedDiffuse::CoatedDiffuse(const Eigen::Array3d& albedo, double index, double roughness)
    : index_(index), alpha_(roughness) {
  for (const double a : albedo) checkCoat(a >= 0 && a <= 1, "albedo", a, "give a number from 0 to 1");
  checkCoat(index >= 1 && index <= 2.5, "index of refraction", index, "give a number from 1 to 2.5");
  checkCoat(roughness >= 0.01 && roughness <= 1, "roughness", roughness, "give a number from 0.01 to 1");
  double mean = 0;  // of the albedo over directions, weighted by the cosine
  for (int i = 0; i <= kAlbedos; ++i) {
    const double cosine = std::max(static_cast<double>(i) / kAlbedos, 1e-3);
    albedos_[static_cast<size_t>(i)] = index > 1 ? ggxAlbedo(cosine, index, roughness) : 0;
    mean += 2 * cosine * albedos_[static_cast<size_t>(i)] * (i % kAlbedos == 0 ? 0.5 : 1.0) / kAlbedos;
  }
  // Reflectances of the two sides of the coat for diffuse light: 1 - inside = (1 - outside) / index^2.
  const double inside = 1 - (1 - mean) / (index * index);
  base_ = albedo / ((1 - albedo * inside) * index * index * std::numbers::pi);
}

double CoatedDiffuse::coatAlbedo(double cosine) const {
  const double place = std::clamp(cosine, 0.0, 1.0) * kAlbedos;
  const int i = std::min(static_cast<int>(place), kAlbedos - 1);
  const double low = albedos_[static_cast<size_t>(i)], high = albedos_[static_cast<size_t>(i) + 1];
  return low + (place - i) * (high - low);
}

double CoatedDiffuse::coatShare(double cosine) const {
  const double reflected = coatAlbedo(cosine);
  const double below = (1 - reflected) * base_.maxCoeff() * std::numbers::pi;
  return reflected > 0 ? std::clamp(reflected / (reflected + below), 0.1, 1.0) : 0;
}

Eigen::Array3d CoatedDiffuse::f(const Eigen::Vector3d& wo, const Eigen::Vector3d& wi) const {
  if (!(wo.z() > 0 && wi.z() > 0)) return {0, 0, 0};
  const Eigen::Vector3d half = (wo + wi).normalized();
  const double coat = coatFresnel(wo.dot(half), index_) * ggxDensity(half.z(), alpha_) *
                      ggxMasking(wo.z(), alpha_) * ggxMasking(wi.z(), alpha_) / (4 * wo.z() * wi.z());
  const double passes = (1 - coatAlbedo(wo.z())) * (1 - coatAlbedo(wi.z()));
  return passes * base_ + coat;
}

double CoatedDiffuse::pdf(const Eigen::Vector3d& wo, const Eigen::Vector3d& wi) const {
  if (!(wo.z() > 0 && wi.z() > 0)) return 0;
  const Eigen::Vector3d half = (wo + wi).normalized();
  const double coat = ggxDensity(half.z(), alpha_) * ggxMasking(wo.z(), alpha_) / (4 * wo.z());
  const double share = coatShare(wo.z());
  return share * coat + (1 - share) * wi.z() / std::numbers::pi;
}

CoatedDiffuse::Sample CoatedDiffuse::sample(const Eigen::Vector3d& wo, double u0, double u1,
                                            double u2) const {
  if (!(wo.z() > 0)) return {};
  Sample sample;
  if (u0 < coatShare(wo.z())) {
    const Eigen::Vector3d half = visibleNormal(wo, alpha_, u1, u2);
    sample.wi = 2 * wo.dot(half) * half - wo;
  } else {
    const double r = std::sqrt(u1), phi = 2 * std::numbers::pi * u2;
    sample.wi = {r * std::cos(phi), r * std::sin(phi), std::sqrt(1 - u1)};
  }
  if (!(sample.wi.z() > 0)) return {};
  sample.pdf = pdf(wo, sample.wi);
  sample.f = f(wo, sample.wi);
  return sample;
}

}  // namespace strandcast
