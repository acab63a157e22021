#include "light/fibre_layers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "light/chiang_fibre.h"

namespace strandcast {
namespace {

/// Shares of light that goes forward and backward, by drawing scattered directions.
LayerScattering drawn(const FibreMaterial& material, double sine, int samples) {
  const ChiangFibre fibre(material);
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> even(0, 1);
  const double cosine = std::sqrt(1 - sine * sine);
  LayerScattering out;
  for (int i = 0; i < samples; ++i) {
    const double azimuth = std::numbers::pi * (even(random) - 0.5);
    const Eigen::Vector3d from(sine, cosine * std::cos(azimuth), cosine * std::sin(azimuth));
    const double h = 2 * even(random) - 1, u0 = even(random), u1 = even(random), u2 = even(random);
    const ChiangFibre::Sample to = fibre.sample(from, h, u0, u1, u2, even(random));
    if (to.pdf <= 0) continue;
    const double weight = to.f[0] * std::hypot(to.wi.y(), to.wi.z()) / to.pdf / samples;
    (to.wi.y() < 0 ? out.forward : out.backward) += weight;
  }
  return out;
}

TEST(FibreLayers, SharesAreThoseOfDrawnDirections) {
  for (const double roughness : {0.1, 0.3, 0.8}) {
    for (const double absorption : {0.0, 0.2, 2.0}) {
      FibreMaterial material;
      material.azimuthal_roughness = material.longitudinal_roughness = roughness;
      material.sigma_a.setConstant(absorption);
      for (const double sine : {0.0, 0.6, -0.9}) {
        const LayerScattering table = FibreLayers(material).at(sine, absorption),
                              truth = drawn(material, sine, 100'000);
        EXPECT_NEAR(table.forward, truth.forward, 5e-3) << roughness << ' ' << absorption << ' ' << sine;
        EXPECT_NEAR(table.backward, truth.backward, 5e-3) << roughness << ' ' << absorption << ' ' << sine;
      }
    }
  }
}

TEST(FibreLayers, ClearFibresLoseNothing) {
  for (const double roughness : {0.001, 0.3, 1.0}) {
    FibreMaterial material;
    material.azimuthal_roughness = roughness;
    for (const double sine : {0.0, 0.5, 1.0}) {
      const LayerScattering layer = FibreLayers(material).at(sine, 0);
      EXPECT_NEAR(layer.forward + layer.backward, 1, 1e-3) << roughness << ' ' << sine;
      EXPECT_GE(layer.backward, 0);
    }
  }
}

TEST(FibreLayers, ForwardLightIsShiftedByTheTiltOfTheScales) {
  FibreMaterial material;
  material.tilt = 0.05;
  material.azimuthal_roughness = 0.1;
  const LayerScattering layer = FibreLayers(material).at(0, 3.0);
  EXPECT_LT(layer.backward_shift, -0.09);                                   // nearly all R: -2 tilt
  EXPECT_NEAR(FibreLayers(material).at(0, 0.0).forward_shift, 0.05, 0.02);  // mostly TT: + tilt
}

}  // namespace
}  // namespace strandcast
