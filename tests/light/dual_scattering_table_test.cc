#include "light/dual_scattering_table.h"

#include <gtest/gtest.h>

#include <cmath>

namespace strandcast {
namespace {

TEST(DualScatteringTable, IsTheStackOfItsFibresBetweenItsKnots) {
  for (const double roughness : {0.1, 0.3, 0.7}) {
    FibreMaterial material;
    material.longitudinal_roughness = material.azimuthal_roughness = roughness;
    const FibreLayers layers(material);
    for (const auto series : {BackscatteringSeries::kPaper, BackscatteringSeries::kFull}) {
      const DualScatteringTable table(material, series);
      for (const double cosine : {1.0, 0.83, 0.41}) {
        for (const double absorption : {0.003, 0.05, 0.4, 2.0, 30.0}) {
          const LayerScattering layer = layers.at(std::sqrt(1 - cosine * cosine), absorption);
          const Backscattering back =
              series == BackscatteringSeries::kPaper ? paperBackscattering(layer) : fullBackscattering(layer);
          const DualScatteringTable::Values values = table.at(cosine, absorption);
          EXPECT_NEAR(values.forward, layer.forward, 2e-3) << cosine << ' ' << absorption;
          EXPECT_NEAR(values.forward_variance, layer.forward_variance, 0.02 * layer.forward_variance);
          EXPECT_NEAR(values.back.attenuation, back.attenuation, 0.01 * back.attenuation + 1e-3)
              << cosine << ' ' << absorption;
          EXPECT_NEAR(values.back.variance, back.variance, 0.02 * back.variance)
              << cosine << ' ' << absorption;
          EXPECT_NEAR(values.back.shift, back.shift, 0.02 * std::abs(back.shift) + 1e-3);
        }
      }
    }
  }
}

TEST(DualScatteringTable, EndsOfTheAbsorptionAxis) {
  const DualScatteringTable table(FibreMaterial{}, BackscatteringSeries::kFull);
  EXPECT_EQ(DualScatteringTable::columnOf(0), 0);
  EXPECT_EQ(DualScatteringTable::columnOf(1e300), 1);
  EXPECT_GT(table.at(1, 0).back.attenuation, 0.7);
  EXPECT_LT(table.at(1, 1e300).back.attenuation, 0.01);
  EXPECT_GT(table.at(1, 1e300).forward, 0);  // the surface still reflects
}

}  // namespace
}  // namespace strandcast
