#include "light/dual_scattering.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <random>

namespace strandcast {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

TEST(DualScattering, HalfTurnTableIsTheMeanOfTheOther) {
  const FibreTable direct(0.3, 1.55), half(0.3, 1.55, FibreTable::kHalfTurnRows, FibreTable::kHalfTurnColumns,
                                           std::nullopt, FibreTable::Incidence::kHalfTurn);
  for (const double cosine : {1.0, 0.5}) {
    for (const double phi : {0.0, 1.0, 2.0, 3.1}) {
      for (const double absorption : {0.0, 0.5, 3.0}) {
        kernels::f64::FibreLobes mean{};
        const int count = 500;
        for (int i = 0; i < count; ++i) {
          const double at = phi + kTurn / 2 * ((i + 0.5) / count - 0.5);
          const kernels::f64::FibreLobes n = direct.at(cosine, kernels::f64::wrappedAngle(at), absorption);
          mean.r += n.r / count;
          mean.tt += n.tt / count;
          mean.trt += n.trt / count;
          mean.residual += n.residual / count;
        }
        const kernels::f64::FibreLobes table = half.at(cosine, phi, absorption);
        EXPECT_NEAR(table.r, mean.r, 2e-3) << cosine << ' ' << phi << ' ' << absorption;
        EXPECT_NEAR(table.tt, mean.tt, 2e-3) << cosine << ' ' << phi << ' ' << absorption;
        EXPECT_NEAR(table.trt, mean.trt, 2e-3) << cosine << ' ' << phi << ' ' << absorption;
        EXPECT_NEAR(table.residual, mean.residual, 2e-3) << cosine << ' ' << phi << ' ' << absorption;
      }
    }
  }
}

TEST(ForwardPath, ManyHairsAreTheMeanOverRaysThatMeetSingleOnes) {
  const Eigen::Array3d forward(0.9, 0.6, 0.2), variance(0.01, 0.02, 0.03);
  const double depth = 1.7;
  std::mt19937 random(5);
  std::poisson_distribution<int> met(depth);
  double direct = 0;
  Eigen::Array3d transmittance(0, 0, 0), spread(0, 0, 0);
  const int rays = 200'000;
  for (int i = 0; i < rays; ++i) {
    ForwardPath path;
    for (int hairs = met(random); hairs > 0; --hairs) path.pass(forward, variance);
    const ForwardScattering light = path.light();
    direct += light.direct / rays;
    transmittance += light.transmittance / rays;
    spread += (1 - light.direct) * light.transmittance * light.variance / rays;
  }
  ForwardPath many;
  many.passMany(0.5 * depth, forward, variance);
  many.passMany(0.5 * depth, forward, variance);
  const ForwardScattering mean = many.light();
  EXPECT_NEAR(mean.direct, direct, 3e-3);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(mean.transmittance[c], transmittance[c], 3e-3) << c;
    EXPECT_NEAR(mean.variance[c], spread[c] / (transmittance[c] - direct), 0.02 * variance[c]) << c;
  }
}

/// Integral over the directions to the eye, with the cosine of their inclination.
DualScattering::Shading sent(const DualScattering& hair, const ForwardScattering& light, double absorption,
                             double sine) {
  const Eigen::Vector3d tangent(1, 0, 0), to_light(sine, std::sqrt(1 - sine * sine), 0);
  DualScattering::Shading sum;
  const int rows = 200, columns = 120;
  for (int i = 0; i < rows; ++i) {
    for (int k = 0; k < columns; ++k) {
      const double s = 2 * (i + 0.5) / rows - 1, c = std::sqrt(1 - s * s), phi = kTurn * (k + 0.5) / columns;
      const DualScattering::Shading part =
          hair.shade(tangent, Eigen::Vector3d(s, c * std::cos(phi), c * std::sin(phi)), to_light,
                     Eigen::Array3d::Constant(absorption), light, {1, 1});
      const double weight = 2.0 / rows * kTurn / columns * c;
      sum.single += weight * part.single;
      sum.global += weight * part.global;
      sum.local += weight * part.local;
    }
  }
  return sum;
}

TEST(DualScattering, ClearFibresSendOnAllLightThatReachesThem) {
  FibreMaterial material;
  material.tilt = 0;
  const DualScattering hair(material, BackscatteringSeries::kFull);
  const DualScattering::Shading direct = sent(hair, {}, 0, 0);
  EXPECT_NEAR(direct.single[0], 1, 0.02);
  EXPECT_EQ(direct.global[0], 0);
  const DualScattering::Shading scattered = sent(hair, {0, {1, 1, 1}, {0.01, 0.01, 0.01}}, 0, 0);
  EXPECT_EQ(scattered.single[0], 0);
  EXPECT_NEAR(scattered.global[0], 1, 0.02);
  EXPECT_NEAR(scattered.local[0], direct.local[0], 0.02 * direct.local[0]);
}

TEST(DualScattering, LocalScatteringIsTheAttenuationOfTheStack) {
  const DualScattering hair(FibreMaterial{}, BackscatteringSeries::kFull);
  const double absorption = 0.3;
  // 2 / pi over all azimuths, where the paper has half of them.
  EXPECT_NEAR(sent(hair, {}, absorption, 0).local[0], 4 * hair.layers().at(1, absorption).back.attenuation,
              0.1 * sent(hair, {}, absorption, 0).local[0]);
}

}  // namespace
}  // namespace strandcast
