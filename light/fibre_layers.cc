#include "light/fibre_layers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace strandcast {
namespace {

constexpr int kAzimuths = 256;        // intervals of forward_
constexpr int kLogisticPoints = 256;  // of the azimuthal distribution
constexpr int kWidthPoints = 64;      // across half a fibre

constexpr double kPi = std::numbers::pi;

}  // namespace

FibreLayers::FibreLayers(const FibreMaterial& material)
    : shape_(fibreShapeOf(material)), tilt_(material.tilt) {
  // Light from azimuths -pi/2 to pi/2 that turns by phi goes forward for |phi| / pi of these azimuths.
  for (int i = 0; i <= kAzimuths; ++i) {
    double sum = 0;
    for (int k = 0; k < kLogisticPoints; ++k)
      sum += std::abs(
          kernels::f64::wrappedAngle(kPi * i / kAzimuths + kernels::f64::trimmedLogisticQuantile(
                                                               (k + 0.5) / kLogisticPoints, shape_.scale)));
    forward_.push_back(sum / (kPi * kLogisticPoints));
  }
}

double FibreLayers::forwardShare(double azimuth) const {
  const double at = std::abs(kernels::f64::wrappedAngle(azimuth)) * (kAzimuths / kPi);
  const auto i = static_cast<size_t>(std::clamp(at, 0.0, kAzimuths - 1.0));
  return forward_[i] + (at - static_cast<double>(i)) * (forward_[i + 1] - forward_[i]);
}

std::vector<LayerScattering> FibreLayers::at(double sine, std::span<const double> absorptions) const {
  const double cosine = std::sqrt(std::max(0.0, (1 - sine) * (1 + sine)));
  struct Point {
    double weight, fresnel, passage;
    std::array<double, 4> forward;  ///< share of R, TT, TRT and longer paths
  };
  std::array<Point, kWidthPoints> points;
  for (size_t k = 0; k < points.size(); ++k) {
    // h and -h scatter alike. Steps of equal angle are fine at the edge, where reflectance rises.
    const double step = kPi / (2 * kWidthPoints), gamma = (static_cast<double>(k) + 0.5) * step;
    const kernels::f64::FibreRay ray = kernels::f64::fibreRay(sine, cosine, std::sin(gamma), shape_.index);
    points[k] = {std::cos(gamma) * step, ray.fresnel, ray.passage, {0, 0, 0, 0.5}};
    for (size_t p = 0; p < 3; ++p)
      points[k].forward[p] = forwardShare(kernels::f64::fibreAzimuth(ray, static_cast<double>(p)));
  }
  std::vector<LayerScattering> layers;
  for (const double absorption : absorptions) {
    std::array<double, 4> forward{}, whole{};
    for (const Point& point : points) {
      const kernels::f64::FibreLobes share =
          kernels::f64::fibreShares(point.fresnel, std::exp(-absorption * point.passage));
      const std::array<double, 4> shares{share.r, share.tt, share.trt, share.residual};
      for (size_t p = 0; p < 4; ++p) {
        whole[p] += point.weight * shares[p];
        forward[p] += point.weight * shares[p] * point.forward[p];
      }
    }
    layers.push_back(layerOf(forward, whole));
  }
  return layers;
}

LayerScattering FibreLayers::layerOf(const std::array<double, 4>& forward,
                                     const std::array<double, 4>& whole) const {
  const std::array<double, 4> shifts{-2 * tilt_, tilt_, 4 * tilt_, 0};
  LayerScattering out;
  for (size_t p = 0; p < 4; ++p) {
    const double variance = kernels::f64::lobeVariance(shape_, static_cast<double>(p)),
                 backward = whole[p] - forward[p];
    out.forward += forward[p];
    out.backward += backward;
    out.forward_shift += forward[p] * shifts[p];
    out.backward_shift += backward * shifts[p];
    out.forward_variance += forward[p] * variance;
    out.backward_variance += backward * variance;
  }
  const double forward_sum = std::max(out.forward, 1e-300), backward_sum = std::max(out.backward, 1e-300);
  out.forward_shift /= forward_sum;
  out.forward_variance /= forward_sum;
  out.backward_shift /= backward_sum;
  out.backward_variance /= backward_sum;
  // Rounding must not make light.
  const double sum = std::max(1.0, out.forward + out.backward);
  out.forward /= sum;
  out.backward /= sum;
  return out;
}

}  // namespace strandcast
