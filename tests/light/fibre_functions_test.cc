// The functions of kernels/fibre.h against the standard library and quadrature.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "kernels/scalar_fibre.h"

namespace strandcast {
namespace {

namespace f32 = kernels::f32;
namespace f64 = kernels::f64;

using std::numbers::pi;

// I0(x) exp(-x) = mean over t of exp(x (cos t - 1)); the midpoint rule converges exponentially.
double scaledBessel(double x) {
  const int n = 4000;
  double sum = 0;
  for (int k = 0; k < n; ++k) sum += std::exp(-2 * x * std::pow(std::sin(0.5 * pi * (k + 0.5) / n), 2));
  return sum / n;
}

TEST(FibreFunctions, LogOfBesselI0IsAccurateEverywhere) {
  double worst = 0, worst_float = 0, worst_relative = 0;
  for (double x = 1e-3; x < 1e5; x *= 1.05) {
    const double exact = scaledBessel(x), logarithm = x + std::log(exact);
    worst = std::max(worst, std::abs(f64::besselI0Scaled(x) / exact - 1));
    worst = std::max(worst, std::abs(f64::logBesselI0(x) - logarithm));
    if (x > 0.1) worst_relative = std::max(worst_relative, std::abs(f64::logBesselI0(x) / logarithm - 1));
    worst_float = std::max(worst_float, std::abs(f32::besselI0Scaled(static_cast<float>(x)) / exact - 1));
  }
  EXPECT_LT(worst, 5e-8);
  EXPECT_LT(worst_relative, 5e-7);
  EXPECT_LT(worst_float, 2e-6);
  // Both sides of the joint, and tables of Abramowitz and Stegun 9.8: exp(-5) I0(5), exp(-10) I0(10).
  EXPECT_NEAR(f64::besselI0Scaled(std::nextafter(5.0, 0.0)), f64::besselI0Scaled(5.0), 1e-8);
  EXPECT_NEAR(f64::besselI0Scaled(5), 0.1835408126, 1e-8);
  EXPECT_NEAR(f64::besselI0Scaled(10), 0.1278333372, 1e-8);
  EXPECT_EQ(f64::besselI0Scaled(0), f64::besselI0Small(0));
}

TEST(FibreFunctions, AnglesAndLogarithmsAgreeWithTheStandardLibrary) {
  double worst = 0, worst_float = 0;
  for (int k = -400; k <= 400; ++k) {
    const double a = pi * k / 400, r = 0.01 * (k + 500);
    const double y = r * std::sin(a), x = r * std::cos(a);
    if (std::abs(k) < 400) worst = std::max(worst, std::abs(f64::fibreAtan(y, x) - std::atan2(y, x)));
    if (std::abs(k) < 400)
      worst_float =
          std::max(worst_float, std::abs(f32::fibreAtan(static_cast<float>(y), static_cast<float>(x)) - a));
    const double h = k / 400.0;
    worst = std::max(worst, std::abs(f64::fibreAsin(h) - std::asin(h)));
    EXPECT_NEAR(f64::fibreLog(std::exp(0.2 * k)), 0.2 * k, 1e-14 * std::max(1.0, std::abs(0.2 * k)));
  }
  EXPECT_LT(worst, 1e-10);
  EXPECT_LT(worst_float, 2e-6);
  EXPECT_EQ(f64::fibreAtan(0, 0), 0);
  EXPECT_EQ(f64::fibreAsin(1), std::asin(1.0));
  EXPECT_NEAR(f64::wrappedAngle(7), 7 - 2 * pi, 1e-15);
  EXPECT_NEAR(f64::wrappedAngle(-4), 2 * pi - 4, 1e-15);
}

TEST(FibreFunctions, LongitudinalFunctionIntegratesToOneAtEveryInclination) {
  for (const double roughness : {0.02, 0.05, 0.3, 0.7, 1.0})
    for (const double theta_o : {-1.5, -0.6, 0.0, 1.2}) {
      const double v = f64::longitudinalVariance(roughness);
      const int n = 40000;
      double sum = 0;
      for (int k = 0; k < n; ++k) {
        const double theta = pi * ((k + 0.5) / n - 0.5);
        sum += f64::longitudinalFunction(std::sin(theta), std::cos(theta), std::sin(theta_o),
                                         std::cos(theta_o), v) *
               std::cos(theta) * pi / n;
      }
      EXPECT_NEAR(sum, 1, 1e-6) << roughness << " " << theta_o;
    }
}

TEST(FibreFunctions, LogisticDistributionIntegratesToOne) {
  for (const double roughness : {0.05, 0.3, 1.0}) {
    const double s = f64::logisticScale(roughness);
    const int n = 20000;
    double sum = 0;
    for (int k = 0; k < n; ++k) sum += f64::trimmedLogistic(pi * ((2 * k + 1.0) / n - 1), s) * 2 * pi / n;
    EXPECT_NEAR(sum, 1, 1e-6) << roughness;
  }
}

TEST(FibreFunctions, FresnelReflectanceAtKnownAngles) {
  EXPECT_NEAR(f64::fresnelReflectance(1, 1.55), std::pow(0.55 / 2.55, 2), 1e-15);
  EXPECT_NEAR(f64::fresnelReflectance(0, 1.55), 1, 1e-15);
  EXPECT_EQ(f64::fresnelReflectance(0.5, 1), 0);
  // At Brewster's angle half of the light, the parallel polarisation, is not reflected.
  const double cosine = 1 / std::sqrt(1 + 1.55 * 1.55), square = 1.55 * 1.55;
  EXPECT_NEAR(f64::fresnelReflectance(cosine, 1.55), 0.5 * std::pow((square - 1) / (square + 1), 2), 1e-15);
}

TEST(FibreFunctions, SharesOfTheLobesSumToOneWithoutAbsorption) {
  for (const double fresnel : {0.0, 0.05, 0.5, 0.999999, 1.0}) {
    const f64::FibreLobes share = f64::fibreShares(fresnel, 1);
    EXPECT_NEAR(share.r + share.tt + share.trt + share.residual, 1, 1e-12) << fresnel;
  }
}

}  // namespace
}  // namespace strandcast
