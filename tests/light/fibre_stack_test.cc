#include "light/fibre_stack.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <random>
#include <utility>

namespace strandcast {
namespace {

/// The same by a random walk from fibre to fibre. A walker passes the first fibre and turns; the fibres that
/// it has passed tell its inclination.
Backscattering walked(const LayerScattering& layer, int walkers) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> even(0, 1);
  int returned = 0;
  std::complex<double> moment = 0;
  for (int i = 0; i < walkers; ++i) {
    int depth = 0, direction = 1, forward = 0, backward = 0;
    while (depth >= 0) {
      const double chance = even(random);
      if (chance >= layer.forward + layer.backward) break;
      if (chance < layer.forward) {
        ++forward;
      } else {
        ++backward;
        direction = -direction;
      }
      depth += direction;
    }
    if (depth >= 0 || forward == 0) continue;  // absorbed, or the first fibre's own
    ++returned;
    const double shift = forward * layer.forward_shift + backward * layer.backward_shift;
    const double variance = forward * layer.forward_variance + backward * layer.backward_variance;
    moment += std::polar(std::exp(-2 * variance), 2 * shift);
  }
  moment /= returned;
  return {static_cast<double>(returned) / walkers, std::arg(moment) / 2, -std::log(std::abs(moment)) / 2};
}

constexpr double kForwardVariance = 0.01, kBackwardVariance = 0.02;  // rad^2

LayerScattering layerOf(double forward, double backward) {
  return {forward, backward, 0.03, -0.06, kForwardVariance, kBackwardVariance};
}

TEST(FibreStack, FullIsTheRandomWalk) {
  for (const auto& [forward, backward] : {std::pair{0.3, 0.1}, {0.6, 0.2}, {0.8, 0.15}, {0.5, 0.45}}) {
    const LayerScattering layer = layerOf(forward, backward);
    const Backscattering full = fullBackscattering(layer), walk = walked(layer, 400'000);
    EXPECT_NEAR(full.attenuation, walk.attenuation, 3e-3) << forward;
    EXPECT_NEAR(full.shift, walk.shift, 2e-3) << forward;
    EXPECT_NEAR(full.variance, walk.variance, 0.02 * walk.variance + 1e-3) << forward;
  }
}

TEST(FibreStack, NothingIsLostWithoutAbsorption) {
  for (const double backward : {0.01, 0.1, 0.5}) {
    const Backscattering full = fullBackscattering(layerOf(1 - backward, backward));
    EXPECT_NEAR(full.attenuation + backward, 1, 1e-12);
    EXPECT_TRUE(std::isfinite(full.variance));
    EXPECT_TRUE(std::isfinite(full.shift));
  }
}

TEST(FibreStack, PaperAgreesWithTheSeriesWhereLittleIsScatteredBack) {
  const LayerScattering layer = layerOf(0.6, 0.02);
  const Backscattering paper = paperBackscattering(layer), full = fullBackscattering(layer);
  EXPECT_NEAR(paper.attenuation, full.attenuation, 0.002 * full.attenuation);
  EXPECT_NEAR(paper.attenuation, 0.02 * 0.36 / 0.64, 0.002 * full.attenuation);  // eq. 11
}

TEST(FibreStack, PaperLeavesMostOfTheLightOfClearFibresOut) {
  const LayerScattering layer = layerOf(0.8, 0.2);
  EXPECT_LT(paperBackscattering(layer).attenuation, 0.8 * fullBackscattering(layer).attenuation);
}

TEST(FibreStack, BlackFibresReturnNothing) {
  for (const Backscattering& black :
       {paperBackscattering(LayerScattering{}), fullBackscattering(LayerScattering{})}) {
    EXPECT_EQ(black.attenuation, 0);
    EXPECT_EQ(black.shift, 0);
    EXPECT_EQ(black.variance, 0);
  }
}

TEST(FibreStack, FibresThatScatterNothingBackHaveALimit) {
  for (const auto& of : {paperBackscattering, fullBackscattering}) {
    const Backscattering none = of(layerOf(0.5, 0)), little = of(layerOf(0.5, 1e-6));
    EXPECT_EQ(none.attenuation, 0);
    EXPECT_NEAR(none.shift, little.shift, 1e-4);
    EXPECT_NEAR(none.variance, little.variance, 1e-4);
  }
}

}  // namespace
}  // namespace strandcast
