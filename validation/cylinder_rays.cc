#include "validation/cylinder_rays.h"

#include <Eigen/Core>
#include <cmath>
#include <numbers>
#include <random>

namespace strandcast {
namespace {

using Eigen::Vector3d;

/// Reflectance for unpolarised light that crosses from index n1 to n2, by Fresnel's amplitudes; 1 where all
/// is reflected.
double reflectanceBetween(double cosine, double n1, double n2) {
  const double sine2 = n1 * n1 / (n2 * n2) * (1 - cosine * cosine);
  if (sine2 >= 1) return 1;
  const double through = std::sqrt(1 - sine2);
  const double s = (n1 * cosine - n2 * through) / (n1 * cosine + n2 * through);
  const double p = (n2 * cosine - n1 * through) / (n2 * cosine + n1 * through);
  return 0.5 * (s * s + p * p);
}

Vector3d reflectedAt(const Vector3d& direction, const Vector3d& normal) {
  return direction - 2 * direction.dot(normal) * normal;
}
/// Snell's law. `normal` points against the direction; n1, n2: indices before and after the surface.
Vector3d refractedAt(const Vector3d& direction, const Vector3d& normal, double n1, double n2) {
  const double ratio = n1 / n2, cosine = -direction.dot(normal);
  return ratio * direction + (ratio * cosine - std::sqrt(1 - ratio * ratio * (1 - cosine * cosine))) * normal;
}

/// The cylinder about x with half axes 1 and `b` along y and z.
struct Section {
  double b;

  Vector3d outward(const Vector3d& at) const { return Vector3d(0, at.y(), at.z() / (b * b)).normalized(); }
  /// Distance along a ray to the farther crossing of the surface.
  double exitDistance(const Vector3d& from, const Vector3d& direction) const {
    const double a = square(direction.y(), direction.z()), c = square(from.y(), from.z()) - 1,
                 half = from.y() * direction.y() + from.z() * direction.z() / (b * b);
    return (-half + std::sqrt(std::max(half * half - a * c, 0.0))) / a;
  }
  double entryDistance(const Vector3d& from, const Vector3d& direction) const {
    return -exitDistance(from, -direction);
  }

 private:
  double square(double y, double z) const { return y * y + z * z / (b * b); }
};

int binOf(double phi) {
  const double turn = phi / (2 * std::numbers::pi) + 0.5;
  const int bin = static_cast<int>((turn - std::floor(turn)) * ScatteredRays::kBins);
  return std::min(bin, ScatteredRays::kBins - 1);
}

}  // namespace

ScatteredRays traceCylinder(const CylinderOptics& cylinder, double theta, int rays, unsigned seed) {
  const Section section{cylinder.axis_ratio};
  const double c = std::cos(cylinder.azimuth), s = std::sin(cylinder.azimuth);
  // The light comes from azimuth and inclination theta and travels the other way.
  const Vector3d travel(-std::sin(theta), -std::cos(theta) * c, -std::cos(theta) * s), across(0, -s, c);
  const double half_width = std::sqrt(s * s + std::pow(section.b * c, 2));
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform;
  ScatteredRays result;
  for (auto& histogram : result.histogram) histogram.assign(ScatteredRays::kBins, 0);
  auto leave = [&](size_t passages, const Vector3d& direction, double weight) {
    result.albedo[passages] += weight;
    const double phi = std::atan2(direction.z(), direction.y()) - cylinder.azimuth;
    result.histogram[passages][static_cast<size_t>(binOf(phi))] += weight;
  };
  for (int ray = 0; ray < rays; ++ray) {
    const double h = 2 * (ray + uniform(random)) / rays - 1;
    const Vector3d start = h * half_width * across - 10 * travel;
    Vector3d at = start + section.entryDistance(start, travel) * travel;
    Vector3d normal = section.outward(at);
    const double reflected = reflectanceBetween(-travel.dot(normal), 1, cylinder.index);
    double weight = 1.0 / rays;
    leave(0, reflectedAt(travel, normal), weight * reflected);
    weight *= 1 - reflected;
    Vector3d direction = refractedAt(travel, normal, 1, cylinder.index);
    for (size_t passages = 1; passages < 3; ++passages) {
      const double distance = section.exitDistance(at, direction);
      at += distance * direction;
      weight *= std::exp(-cylinder.sigma_a * distance);
      normal = section.outward(at);
      const double kept = reflectanceBetween(direction.dot(normal), cylinder.index, 1);
      if (kept < 1) leave(passages, refractedAt(direction, -normal, cylinder.index, 1), weight * (1 - kept));
      weight *= kept;
      direction = reflectedAt(direction, normal);
    }
    result.rest += weight;
  }
  return result;
}

double roughenedDensity(const std::vector<double>& histogram, double s, double phi) {
  const double bins = static_cast<double>(histogram.size());
  const double whole = std::tanh(std::numbers::pi / (2 * s));  // of the untrimmed distribution
  double sum = 0;
  for (size_t bin = 0; bin < histogram.size(); ++bin) {
    const double at = (2 * (static_cast<double>(bin) + 0.5) / bins - 1) * std::numbers::pi;
    const double off = std::remainder(phi - at, 2 * std::numbers::pi), sech = 1 / std::cosh(off / (2 * s));
    sum += histogram[bin] * sech * sech / (4 * s * whole);
  }
  return sum;
}

}  // namespace strandcast
