#include "light/coated_diffuse.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "light/random_stream.h"
#include "tests/expect_error.h"

namespace strandcast {
namespace {

Eigen::Vector3d directionOf(double cosine, double phi) {
  const double sine = std::sqrt(1 - cosine * cosine);
  return {sine * std::cos(phi), sine * std::sin(phi), cosine};
}

TEST(CoatedDiffuse, SamplingHasItsDensityAndTheReflectanceOfUniformSampling) {
  const CoatedDiffuse skin({0.6, 0.4, 0.3}, 1.4, 0.35);
  SampleStream random(4, 5, 6);
  constexpr int kSamples = 300000;
  for (const double cosine : {0.95, 0.5, 0.15}) {
    const Eigen::Vector3d wo = directionOf(cosine, 0.7);
    Eigen::Array3d drawn{0, 0, 0}, uniform{0, 0, 0};
    double whole = 0, above = 0;
    for (int i = 0; i < kSamples; ++i) {
      const CoatedDiffuse::Sample s = skin.sample(wo, random.uniform(), random.uniform(), random.uniform());
      if (s.pdf > 0) {
        above += 1.0 / kSamples;
        drawn += s.f * (s.wi.z() / s.pdf / kSamples);
      }
      const Eigen::Vector3d wi =
          directionOf(std::max(random.uniform(), 1e-9), 2 * std::numbers::pi * random.uniform());
      whole += 2 * std::numbers::pi * skin.pdf(wo, wi) / kSamples;
      uniform += skin.f(wo, wi) * (2 * std::numbers::pi * wi.z() / kSamples);
      EXPECT_NEAR(skin.f(wo, wi)[0], skin.f(wi, wo)[0], 1e-9 * skin.f(wo, wi)[0] + 1e-12);
    }
    EXPECT_NEAR(whole, above, 0.02);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(drawn[c], uniform[c], 0.02 * uniform[c]);
    EXPECT_LT(drawn.maxCoeff(), 0.9);
  }
}

TEST(CoatedDiffuse, AWhiteOneReflectsAllLight) {
  for (const auto& [index, roughness] : {std::pair{1.0, 0.3}, {1.4, 0.02}, {1.6, 0.02}, {1.4, 0.5}}) {
    const CoatedDiffuse white({1, 1, 1}, index, roughness);
    SampleStream random(4, 5, 7);
    constexpr int kSamples = 200000;
    for (const double cosine : {1.0, 0.6, 0.3}) {
      double sum = 0;
      for (int i = 0; i < kSamples; ++i) {
        const CoatedDiffuse::Sample s =
            white.sample(directionOf(cosine, 0), random.uniform(), random.uniform(), random.uniform());
        if (s.pdf > 0) sum += s.f[1] * s.wi.z() / s.pdf / kSamples;
      }
      EXPECT_NEAR(sum, 1, 0.006) << index << " " << roughness << " " << cosine;
    }
  }
}

TEST(CoatedDiffuse, RefusesValuesOutOfRange) {
  expectError([] { CoatedDiffuse({1, 2, 0}, 1.4, 0.3); }, {"albedo is 2"});
  expectError([] { CoatedDiffuse({1, std::nan(""), 0}, 1.4, 0.3); }, {"albedo is nan"});
  expectError([] { CoatedDiffuse({1, 1, 0}, 0.9, 0.3); }, {"index of refraction is 0.9"});
  expectError([] { CoatedDiffuse({1, 1, 0}, 1.4, 0); }, {"roughness is 0"});
}

}  // namespace
}  // namespace strandcast
