#include "light/far_fibre.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "light/chiang_fibre.h"
#include "tests/expect_error.h"

namespace strandcast {
namespace {

using std::numbers::pi;

Eigen::Vector3d toDirection(double theta, double phi) {
  return {std::sin(theta), std::cos(theta) * std::cos(phi), std::cos(theta) * std::sin(phi)};
}

FibreMaterial materialOf(double roughness, double sigma) {
  FibreMaterial material;
  material.longitudinal_roughness = material.azimuthal_roughness = roughness;
  material.sigma_a = sigma * Eigen::Array3d(1, 0.5, 0);
  return material;
}

/// Mean of f over h by the midpoint rule in asin(h), whose weight is its cosine.
Eigen::Array3d meanOverFibre(const ChiangFibre& fibre, const Eigen::Vector3d& wo, const Eigen::Vector3d& wi,
                             int points) {
  Eigen::Array3d sum = Eigen::Array3d::Zero();
  for (int k = 0; k < points; ++k) {
    const double gamma = pi * ((k + 0.5) / points - 0.5);
    sum += fibre.f(wo, wi, std::sin(gamma)) * (std::cos(gamma) * 0.5 * pi / points);
  }
  return sum;
}

TEST(FarFibre, IsTheMeanOfTheNearFieldOverTheFibre) {
  for (const double roughness : {0.2, 0.3, 0.6, 1.0}) {
    const auto table = std::make_shared<const FibreTable>(roughness, 1.55);
    for (const double sigma : {0.1, 1.3, 8.0}) {
      const FibreMaterial material = materialOf(roughness, sigma);
      const ChiangFibre near(material);
      const FarChiangFibre far(material, table);
      double worst = 0;
      for (const double theta : {-1.3, -0.5, 0.0, 0.8})
        for (int k = 0; k < 24; ++k)
          for (const double off : {-0.1, 0.04}) {
            const Eigen::Vector3d wo = toDirection(theta, 0.3),
                                  wi = toDirection(off - theta, 0.3 - 2 * pi * (k + 0.4) / 24);
            const Eigen::Array3d exact = meanOverFibre(near, wo, wi, 800), value = far.f(wo, wi);
            worst = std::max(worst, (value / exact - 1).abs().maxCoeff());
          }
      EXPECT_LT(worst, 0.01) << roughness << " " << sigma;
    }
  }
}

TEST(FarFibre, SixtyFourPointsAcrossTheFibreAgree) {
  const FibreMaterial material = fibrePreset("brown");
  const ChiangFibre near(material);
  const FarChiangFibre far(material);
  for (int k = 0; k < 40; ++k) {
    const Eigen::Vector3d wo = toDirection(0.2, 0), wi = toDirection(-0.25, pi * (k + 0.5) / 20);
    const Eigen::Array3d few = meanOverFibre(near, wo, wi, 64);
    EXPECT_LT((far.f(wo, wi) / few - 1).abs().maxCoeff(), 0.01) << k;
  }
}

TEST(FarFibre, TableIsSmallAndConservesEnergy) {
  const FibreTable table(0.3, 1.55);
  EXPECT_LE(table.numbers().size_bytes(), 1000000u);
  for (const double cos_theta : {1.0, 0.613, 0.2}) {
    double sum = 0, r = 0;
    const int n = 2000;
    for (int k = 0; k < n; ++k) {
      const kernels::f64::FibreLobes lobes = table.at(cos_theta, pi * (k + 0.5) / n, 0);
      sum += 2 * pi / n * (lobes.r + lobes.tt + lobes.trt + lobes.residual);
      r += 2 * pi / n * table.at(cos_theta, -pi * (k + 0.5) / n, 1000).r;
      EXPECT_EQ(table.at(cos_theta, 1, 1000).tt, 0);
    }
    EXPECT_NEAR(sum, 1, 2e-3) << cos_theta;
    EXPECT_GT(r, 0.03);
    EXPECT_LT(r, sum);
  }
}

TEST(FarFibre, BelowTheLeastRoughnessTablesStayAtIt) {
  const FibreTable least(FibreTable::kLeastRoughness, 1.55), narrower(0.01, 1.55);
  EXPECT_EQ(least.at(0.8, 1, 0).trt, narrower.at(0.8, 1, 0).trt);
  EXPECT_NE(least.at(0.8, 1, 0).trt, FibreTable(0.2, 1.55).at(0.8, 1, 0).trt);
}

TEST(MarschnerFibre, IsReciprocal) {
  for (const double axis_ratio : {1.0, 0.9}) {
    FibreMaterial material = materialOf(0.3, 0.4);
    material.axis_ratio = axis_ratio;
    const MarschnerFibre fibre(material);
    for (int k = 0; k < 50; ++k) {
      const Eigen::Vector3d a = toDirection(std::sin(3.0 * k), 1.0 * k),
                            b = toDirection(std::cos(7.0 * k), 2.3 * k);
      EXPECT_TRUE(fibre.f(a, b).isApprox(fibre.f(b, a), 1e-6)) << k;
    }
  }
}

TEST(MarschnerFibre, ReturnsTheSharesOfThreeLobesAtNormalIncidence) {
  FibreMaterial material = materialOf(0.2, 0);
  material.tilt = 0;
  const MarschnerFibre fibre(material);
  double sum = 0, shares = 0;
  const int n = 400;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double theta = pi * ((i + 0.5) / n - 0.5);
      sum += fibre.f(toDirection(0, 0), toDirection(theta, 2 * pi * j / n))[0] *
             std::pow(std::cos(theta), 2) * 2 * pi * pi / (n * n);
    }
  for (int k = 0; k < 1000; ++k) {
    const kernels::f64::FibreRay ray = kernels::f64::fibreRay(0, 1, (k + 0.5) / 1000, 1.55);
    shares += (1 - kernels::f64::fibreShares(ray.fresnel, 1).residual) / 1000;
  }
  EXPECT_NEAR(shares, 0.9924, 2e-4);  // 0.76 % is in longer paths
  EXPECT_NEAR(sum, shares, 0.02);     // Gaussians lose some near the axis
}

TEST(MarschnerFibre, SlightlyEllipticFibresApproachRoundOnes) {
  FibreMaterial material = materialOf(0.3, 0.4);
  const MarschnerFibre round(material);
  material.axis_ratio = 0.999;
  const MarschnerFibre slight(material);
  material.axis_ratio = 0.85;
  const MarschnerFibre flat(material);
  EXPECT_LE(flat.numbers().size_bytes(), 1000000u);
  double most = 0;
  for (int k = 0; k < 60; ++k) {
    const Eigen::Vector3d wo = toDirection(0.1, 0.05 * k), wi = toDirection(-0.2, 0.1 * k);
    EXPECT_TRUE(slight.f(wo, wi).isApprox(round.f(wo, wi), 0.02)) << k;
    most = std::max(most, (flat.f(wo, wi) / round.f(wo, wi) - 1).abs().maxCoeff());
  }
  EXPECT_GT(most, 0.1);
}

TEST(MarschnerFibre, BadLobesAreRefused) {
  kernels::f64::MarschnerLobes lobes = marschnerLobes({});
  lobes.width.y = 0;
  expectError([&] { MarschnerFibre({}, lobes); }, {"width of a lobe"});
  FibreMaterial material;
  material.axis_ratio = 0.2;
  expectError([&] { MarschnerFibre{material}; }, {"axis"});
}

}  // namespace
}  // namespace strandcast
