// Each solution is compared with published values or with an independent computation.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "validation/rest_shapes.h"
#include "validation/vibrations.h"

namespace strandcast {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(ExactSolutions, HeavyElastica) {
  struct Row {
    double gamma, drop, reach, slope;
  };
  for (const Row& row :
       {Row{0.1, 0.012498, 0.999911, 0.012500}, Row{1, 0.123471, 0.991246, 0.124562},
        Row{10, 0.700200, 0.656354, 1.066802}, Row{100, 0.937524, 0.159223, 5.888105},
        Row{1000, 0.981141, 0.045986, 21.335440}, Row{10000, 0.994110, 0.014261, 69.708830}}) {
    const ElasticaTip tip = restingElastica(row.gamma, 0);
    EXPECT_NEAR(tip.drop, row.drop, 2e-6) << row.gamma;
    EXPECT_NEAR(tip.reach, row.reach, 2e-6) << row.gamma;
    EXPECT_NEAR(tip.slope() / row.slope, 1, 5e-5) << row.gamma;
  }
}

TEST(ExactSolutions, ElasticaWithTipLoad) {
  struct Row {
    double alpha, drop, shortfall;
  };
  for (const Row& row : {Row{0.5, 0.162144, 0.015919}, Row{1, 0.301721, 0.056433}, Row{2, 0.493457, 0.160642},
                         Row{10, 0.810609, 0.554996}}) {
    const ElasticaTip tip = restingElastica(0, row.alpha);
    EXPECT_NEAR(tip.drop, row.drop, 2e-6) << row.alpha;
    EXPECT_NEAR(1 - tip.reach, row.shortfall, 2e-6) << row.alpha;
  }
  // Small deflections superpose: w L^4 / (8 B) and P L^3 / (3 B).
  EXPECT_NEAR(restingElastica(1e-3, 2e-3).drop, 1e-3 / 8 + 2e-3 / 3, 1e-8);
  // The integral of moment x distance from the tip / stiffness over both halves.
  const ElasticaStep half{0.5, 0.25};
  EXPECT_NEAR(restingElastica(1e-3, 0, half).drop, 1e-3 / 8 * (15.0 / 16 + 4 * 1.0 / 16), 1e-8);
  EXPECT_NEAR(restingElastica(0, 1e-3, half).drop, 1e-3 / 3 * (7.0 / 8 + 4 * 1.0 / 8), 1e-8);
  // Linearly growing weight: w L^4 / (8 B) plus, of the growing part, 11 L^4 / (120 B) (Roark).
  EXPECT_NEAR(restingElastica(1e-3, 0, {0, 1, 1, 2}).drop, 1e-3 * (1.0 / 8 + 2 * 11.0 / 120), 1e-8);
  // Growth on the outer half only: its resultant W = w L / 4, at two thirds of that half, also bends the
  // inner half by the force W and the moment W L / 3.
  const double force = 0.25, moment = 0.25 / 3, half_drop = force / 24 + moment / 8,
               half_slope = force / 8 + moment / 2;
  EXPECT_NEAR(restingElastica(1e-3, 0, {0.5, 1, 1, 1}).drop - restingElastica(1e-3, 0).drop,
              1e-3 * (11.0 / 120 / 16 + half_drop + half_slope / 2), 1e-8);
  // Weightless outer half: w (L / 2)^4 / (8 B), continued to the tip with the slope w (L / 2)^3 / (6 B).
  EXPECT_NEAR(restingElastica(1e-3, 0, {0.5, 1, 0}).drop, 1e-3 * (1.0 / 128 + 1.0 / 96), 1e-8);
}

TEST(ExactSolutions, Modes) {
  const double beam[] = {3.51602, 22.0345, 61.6972}, chain[] = {1.20241, 2.76004, 4.32686};
  for (int n = 1; n <= 3; ++n) {
    EXPECT_NEAR(beamRoot(n) * beamRoot(n), beam[n - 1], 1e-4);
    EXPECT_NEAR(chainRoot(n) / 2, chain[n - 1], 1e-5);
    EXPECT_NEAR(chainShape(n, 0), 0, 1e-12);
    EXPECT_NEAR(chainShape(n, 1), 1, 1e-12);
    EXPECT_NEAR(beamShape(n, 0), 0, 1e-9);
    EXPECT_NEAR(std::fabs(beamShape(n, 1)), 2, 1e-6);
  }
}

TEST(ExactSolutions, ChainsOfUnevenDensity) {
  for (int n = 1; n <= 3; ++n) {
    const UnevenChain even(n, 1), light(n, 1e-6);
    EXPECT_NEAR(even.frequency(), chainRoot(n) / 2, 1e-5);
    for (const double s : {0.0, 0.3, 0.8, 1.0}) EXPECT_NEAR(even.shape(s), chainShape(n, s), 1e-5) << s;
    // Density that vanishes at the tip: y = J1(r sqrt(u)) / sqrt(u), r the n-th root of J1; frequency r /
    // sqrt(8).
    const double roots[] = {3.831706, 7.015587, 10.173468};
    EXPECT_NEAR(light.frequency(), roots[n - 1] / std::sqrt(8.0), 1e-4);
    EXPECT_NEAR(light.shape(0), 0, 1e-6);
  }
}

TEST(ExactSolutions, Pendulum) {
  const double degrees[] = {10, 30, 60, 90}, period[] = {1.001907, 1.017409, 1.073182, 1.180341};
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(pendulumPeriod(degrees[i] * kPi / 180), period[i], 1e-6);
}

TEST(ExactSolutions, Catenary) {
  const double span[] = {0.2, 0.4, 0.5, 0.6, 0.8}, sag[] = {0.472834, 0.427752, 0.398194, 0.362782, 0.265438};
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(catenarySag(span[i]), sag[i], 1e-6);
}

TEST(ExactSolutions, AHungRodWithoutCurvatureClampedLevelIsTheElastica) {
  HungRod rod;
  rod.gamma = 10;
  rod.down = Eigen::Vector3d(1, 0, 0);
  EXPECT_NEAR(hangingDepth(rod), 0.700200, 2e-6);
}

TEST(ExactSolutions, AHeavyHelixKeepsItsPitchWithoutWeightAndLengthensWithIt) {
  constexpr double kRadius = 0.01, kRise = 0.01 / (2 * kPi), kLength = 0.2;
  const double square = kRadius * kRadius + kRise * kRise;
  HungRod rod;
  rod.curvature = kLength * kRadius / square;
  rod.torsion = kLength * kRise / square;
  rod.down = Eigen::Vector3d(0, kRadius, kRise) / std::sqrt(square);
  EXPECT_NEAR(hangingDepth(rod), kRise / std::sqrt(square), 1e-9);
  rod.gamma = 4 * 1300 * 9.81 * std::pow(kLength, 3) / (4e9 * 40e-6 * 40e-6);
  EXPECT_NEAR(kLength * hangingDepth(rod), 0.05185, 2e-5);
}

TEST(ExactSolutions, BendTwistThreshold) {
  const double phi[] = {2 * kPi, 8, 3 * kPi, 10, 4 * kPi, 5 * kPi};
  const double gamma[] = {44.76, 113.93, 190.37, 227.79, 452.5, 883.8};
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(bendTwistThreshold(phi[i], 1 / 1.45) / gamma[i], 1, 2e-4);
  EXPECT_TRUE(std::isnan(bendTwistThreshold(40, 1 / 1.45)));
}

TEST(Oscillation, FrequencyAndDampingOfADecayingSine) {
  constexpr double kInterval = 1.0 / 360, kOmega = 7, kDecay = 0.3;
  std::vector<double> samples;
  for (int i = 1; i < 2000; ++i) {
    const double t = i * kInterval;
    samples.push_back(std::exp(-kDecay * t) * std::sin(kOmega * t));
  }
  const Oscillation found = oscillationOf(samples, kInterval);
  EXPECT_NEAR(found.angular_frequency, kOmega, 1e-4);
  EXPECT_NEAR(found.decrement, kDecay * 2 * kPi / kOmega, 1e-4);
  EXPECT_NEAR(found.dampingRatio(), kDecay / std::hypot(kDecay, kOmega), 1e-5);
  EXPECT_NEAR(found.energyLostPerCycle(), 1 - std::exp(-4 * kPi * kDecay / kOmega), 1e-4);
  EXPECT_TRUE(std::isnan(oscillationOf(std::vector<double>(100, 1.0), kInterval).angular_frequency));
}

TEST(WindElastica, AWeakWindBendsAStrandAsABeam) {
  // Uniformly loaded cantilever: w L^4 / (8 B).
  EXPECT_NEAR(windElastica(1e-3, 0.5).downwind / 1e-3, 1.0 / 8, 1e-5);
  EXPECT_NEAR(windElastica(1e-3, 0.5).across, 1, 1e-5);
  EXPECT_GT(windElastica(1e4, 0.5).downwind, 0.98) << "a strong wind lays it along itself";
}

}  // namespace
}  // namespace strandcast
