#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "validation/cylinder_rays.h"
#include "validation/suite.h"

namespace strandcast {
namespace {

using std::numbers::pi;

TEST(CylinderRays, ConserveLightAndReflectAsFresnelSays) {
  const ScatteredRays rays = traceCylinder({}, 0.5, 20000, 1);
  EXPECT_NEAR(rays.albedo[0] + rays.albedo[1] + rays.albedo[2] + rays.rest, 1, 1e-12);
  for (size_t p = 0; p < 3; ++p) {
    double sum = 0;
    for (const double share : rays.histogram[p]) sum += share;
    EXPECT_NEAR(sum, rays.albedo[p], 1e-12);
  }
  // Index 1: everything passes straight through.
  const ScatteredRays none = traceCylinder({1, 0}, 0.3, 1000, 1);
  EXPECT_NEAR(none.albedo[1], 1, 1e-12);
  EXPECT_NEAR(none.histogram[1].front() + none.histogram[1].back(), 1, 1e-12);
}

TEST(CylinderRays, AbsorptionIsThatOfTheMeanChord) {
  // With index 1 a ray at h crosses 2 sqrt(1 - h^2) / cos(theta) radii.
  const double sigma = 0.4, theta = 0.6;
  double exact = 0;
  for (int k = 0; k < 10000; ++k) {
    const double h = (k + 0.5) / 10000;
    exact += std::exp(-sigma * 2 * std::sqrt(1 - h * h) / std::cos(theta)) / 10000;
  }
  EXPECT_NEAR(traceCylinder({1, sigma}, theta, 20000, 2).albedo[1], exact, 1e-4);
}

TEST(CylinderRays, ASectionTurnedByAQuarterIsOneOfExchangedAxes) {
  // Seen along z, a section with axes 1 and 0.8 is one with axes 0.8 and 1 seen along y, and scaled, 1
  // and 1.25.
  const ScatteredRays flat = traceCylinder({1.55, 0, 0.8, pi / 2}, 0, 50000, 3),
                      turned = traceCylinder({1.55, 0, 1.25, 0}, 0, 50000, 3);
  for (size_t p = 0; p < 3; ++p) EXPECT_NEAR(flat.albedo[p], turned.albedo[p], 1e-3);
  EXPECT_GT(std::abs(flat.albedo[2] - traceCylinder({}, 0, 50000, 3).albedo[2]), 0.01);
}

TEST(CylinderRays, RoughnessSpreadsAHistogramByTheLogisticDistribution) {
  std::vector<double> histogram(ScatteredRays::kBins);
  histogram[ScatteredRays::kBins / 2] = 0.7;
  double sum = 0;
  for (int k = 0; k < 720; ++k) sum += roughenedDensity(histogram, 0.1, pi * (k - 359.5) / 360) * pi / 360;
  EXPECT_NEAR(sum, 0.7, 1e-6);
  EXPECT_NEAR(roughenedDensity(histogram, 0.1, 0.0), 0.7 / 0.4, 1e-3);
}

TEST(LightSuite, QuickExperimentsPassAndNameTheirCases) {
  const Suite suite = lightSuite();
  const Laboratory laboratory(makeReferenceBackend, SolverKind::kRod);
  std::set<std::string> names;
  for (const Experiment& experiment : suite.experiments) {
    for (const std::string& name : experiment.cases) EXPECT_TRUE(names.insert(name).second) << name;
    const std::string& first = experiment.cases.front();
    const bool quick =
        first.starts_with("log I0") || first.starts_with("rays") || first.starts_with("reciprocity");
    if (!quick) continue;
    const std::vector<Case> cases = experiment.run(laboratory);
    ASSERT_EQ(cases.size(), experiment.cases.size());
    for (size_t i = 0; i < cases.size(); ++i) {
      EXPECT_EQ(cases[i].name, experiment.cases[i]);
      EXPECT_TRUE(cases[i].passed) << cases[i].name << ": " << cases[i].error << ' ' << cases[i].error_unit;
    }
  }
  EXPECT_GE(names.size(), 100u);
}

}  // namespace
}  // namespace strandcast
