#include "light/chiang_fibre.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "core/error.h"

namespace strandcast {
namespace {

using std::numbers::pi;

Eigen::Vector3d directionOf(double theta, double phi) {
  return {std::sin(theta), std::cos(theta) * std::cos(phi), std::cos(theta) * std::sin(phi)};
}
double cosineOf(const Eigen::Vector3d& w) { return std::hypot(w.y(), w.z()); }

FibreMaterial clearFibre(double roughness, double tilt) {
  FibreMaterial material;
  material.sigma_a.setZero();
  material.longitudinal_roughness = material.azimuthal_roughness = roughness;
  material.tilt = tilt;
  return material;
}

/// Integral over the sphere by a grid in sin(theta) and phi.
template <class Function>
double sphereIntegral(int n, const Function& of) {
  double sum = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < 2 * n; ++j) {
      const double sine = (2 * i + 1.0) / n - 1;
      sum += of(directionOf(std::asin(sine), pi * (j + 0.5) / n));
    }
  return sum * 2 * pi / (n * n);
}

TEST(ChiangFibre, ClearFibreReturnsAllLightAndItsPdfIntegratesToOne) {
  for (const double roughness : {0.25, 0.6, 1.0})
    for (const double tilt : {0.0, 0.0349, 0.0873}) {
      const ChiangFibre fibre(clearFibre(roughness, tilt));
      for (const double h : {-0.9, 0.0, 0.5}) {
        const Eigen::Vector3d wo = directionOf(0.7, 0.3);
        EXPECT_NEAR(sphereIntegral(200, [&](const auto& wi) { return fibre.f(wo, wi, h)[1] * cosineOf(wi); }),
                    1, 2e-3);
        EXPECT_NEAR(sphereIntegral(200, [&](const auto& wi) { return fibre.pdf(wo, wi, h); }), 1, 2e-3);
      }
    }
}

// Shares of bins over the sphere: sampled, and by the integral of the density.
TEST(ChiangFibre, SamplesHaveTheDensityThatPdfSays) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<> uniform;
  for (const double roughness : {0.2, 0.5, 0.9})
    for (const double tilt : {0.0, 0.0349, 0.0873}) {
      FibreMaterial material;
      material.longitudinal_roughness = material.azimuthal_roughness = roughness;
      material.tilt = tilt;
      const ChiangFibre fibre(material);
      const Eigen::Vector3d wo = directionOf(-0.5, 1.1);
      const double h = 0.35;
      constexpr int kBins = 12, kFine = 24, kSamples = 60000;
      Eigen::ArrayXXd expected = Eigen::ArrayXXd::Zero(kBins, 2 * kBins), found = expected;
      auto binOf = [](double sine, double phi) {
        const auto row = std::min(static_cast<int>(0.5 * (sine + 1) * kBins), kBins - 1);
        const double turn = phi / (2 * pi) - std::floor(phi / (2 * pi));
        return std::pair(row, std::min(static_cast<int>(turn * 2 * kBins), 2 * kBins - 1));
      };
      for (int i = 0; i < kBins * kFine; ++i)
        for (int j = 0; j < 2 * kBins * kFine; ++j) {
          const double sine = (2 * i + 1.0) / (kBins * kFine) - 1, phi = pi * (j + 0.5) / (kBins * kFine);
          const auto [row, column] = binOf(sine, phi);
          expected(row, column) += fibre.pdf(wo, directionOf(std::asin(sine), phi), h);
        }
      expected *= 2 * pi / (kBins * kFine * kBins * kFine) * kSamples;
      for (int k = 0; k < kSamples; ++k) {
        const auto s =
            fibre.sample(wo, h, uniform(random), uniform(random), uniform(random), uniform(random));
        const auto [row, column] = binOf(s.wi.x(), std::atan2(s.wi.z(), s.wi.y()));
        ++found(row, column);
        EXPECT_NEAR(s.pdf, fibre.pdf(wo, s.wi, h), 1e-6 * s.pdf);
        EXPECT_TRUE(s.f.isApprox(fibre.f(wo, s.wi, h), 1e-6));
      }
      double chi2 = 0, rest_expected = 0, rest_found = 0;
      int freedom = -1;
      for (Eigen::Index b = 0; b < expected.size(); ++b) {
        const double e = expected.reshaped()[b], n = found.reshaped()[b];
        if (e < 10) {
          rest_expected += e;
          rest_found += n;
          continue;
        }
        chi2 += (n - e) * (n - e) / e;
        ++freedom;
      }
      if (rest_expected > 5) {
        chi2 += std::pow(rest_found - rest_expected, 2) / rest_expected;
        ++freedom;
      }
      // Mean and standard deviation of the distribution are freedom and sqrt(2 freedom).
      EXPECT_LT(chi2, freedom + 4 * std::sqrt(2.0 * freedom)) << roughness << " " << tilt;
    }
}

TEST(ChiangFibre, TiltShiftsHighlightsTowardsTheRootAndInnerOnesTowardsTheTip) {
  FibreMaterial material = clearFibre(0.1, 0.05);
  material.azimuthal_roughness = 0.3;
  const double theta_o = 0.4;
  // theta_i of the maximum of f at a difference of azimuths.
  auto peak = [&](const ChiangFibre& fibre, double phi, double h) {
    double best = 0, at = 0;
    for (double theta = -0.9; theta < 0.5; theta += 1e-3) {
      const double value = fibre.f(directionOf(theta_o, 0), directionOf(theta, -phi), h)[0] * std::cos(theta);
      if (value > best) best = value, at = theta;
    }
    return at;
  };
  // Through the middle R leaves at phi = 0 together with TRT; TT at phi = pi.
  EXPECT_NEAR(peak(ChiangFibre(material), pi, 0), -theta_o + 0.05, 3e-3);
  material.sigma_a.setConstant(100);
  EXPECT_NEAR(peak(ChiangFibre(material), 0, 0), -theta_o - 0.1, 3e-3);
  // A TRT that leaves away from R.
  material.sigma_a.setZero();
  material.azimuthal_roughness = 0.05;
  const double gamma_o = std::asin(0.8),
               gamma_t = std::asin(0.8 * std::cos(theta_o) /
                                   std::sqrt(1.55 * 1.55 - std::pow(std::sin(theta_o), 2)));
  EXPECT_NEAR(peak(ChiangFibre(material), 4 * gamma_t - 2 * gamma_o + 2 * pi, 0.8), -theta_o + 0.2, 6e-3);
}

TEST(ChiangFibre, LightThatHSaysLeavesOnThatSide) {
  FibreMaterial black = clearFibre(0.1, 0);
  black.sigma_a.setConstant(1000);
  const ChiangFibre fibre(black);
  // The normal at h = 0.5 is 30 degrees from wo; light that is reflected there comes from 60 degrees.
  const Eigen::Vector3d wo = directionOf(0, 0.2);
  double best = 0, at = 0;
  for (double phi = -pi; phi < pi; phi += 0.01) {
    const double value = fibre.f(wo, directionOf(0, phi), 0.5)[0];
    if (value > best) best = value, at = phi;
  }
  EXPECT_NEAR(at, 0.2 + pi / 3, 0.011);
}

TEST(ChiangFibre, IsReciprocalBetweenEqualInclinationsWithoutTilt) {
  FibreMaterial material;
  material.tilt = 0;
  const ChiangFibre fibre(material);
  for (const double theta_i : {0.6, -0.6})
    for (const double phi : {0.1, 1.9, -2.8})
      for (const double h : {-0.7, 0.3}) {
        const Eigen::Vector3d wo = directionOf(0.6, 0.4), wi = directionOf(theta_i, phi);
        EXPECT_TRUE(fibre.f(wo, wi, h).isApprox(fibre.f(wi, wo, -h), 1e-9));
      }
}

TEST(ChiangFibre, StaysFiniteAtTheEndsOfEveryRange) {
  for (const double roughness : {0.001, 1.0})
    for (const double index : {1.0, 1.55, 2.5})
      for (const double sigma : {0.0, 1000.0})
        for (const double tilt : {-0.35, 0.35}) {
          FibreMaterial material = clearFibre(roughness, tilt);
          material.index = index;
          material.sigma_a.setConstant(sigma);
          const ChiangFibre fibre(material);
          for (const Eigen::Vector3d& wo :
               {directionOf(0, 0), directionOf(pi / 2, 0), directionOf(-1.5, 2), Eigen::Vector3d(-1, 0, 0)})
            for (const double h : {-1.0, 0.0, 1.0})
              for (int k = 0; k < 16; ++k) {
                const auto end = [&](int bit) { return (k >> bit) & 1 ? 1.0 : 0.0; };
                const auto s = fibre.sample(wo, h, end(0), end(1), end(2), end(3));
                ASSERT_TRUE(s.wi.allFinite() && s.f.allFinite() && std::isfinite(s.pdf) && s.pdf >= 0);
                EXPECT_NEAR(s.wi.norm(), 1, 1e-9);
                EXPECT_LE(s.f.maxCoeff() * cosineOf(s.wi), s.pdf * (1 + 1e-6));
                EXPECT_TRUE(fibre.f(wo, wo, h).allFinite());
              }
        }
}

TEST(ChiangFibre, BadMaterialIsRefused) {
  FibreMaterial material;
  material.longitudinal_roughness = 0;
  EXPECT_THROW(ChiangFibre{material}, Error);
}

}  // namespace
}  // namespace strandcast
