#include "core/distance_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "kernels/scalar_strands.h"

namespace strandcast {
namespace {

namespace k = kernels::f64;

TEST(DistanceField, TheInterpolantIsTrilinearAndItsGradientExact) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int item = 0; item < 100; ++item) {
    double v[8];
    for (double& x : v) x = uniform(random);
    const auto at = [&](double x, double y, double z, k::real3& gradient) {
      return k::trilinear(v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7], {x, y, z}, gradient);
    };
    k::real3 gradient, unused;
    for (int c = 0; c < 8; ++c) EXPECT_NEAR(at(c & 1, c >> 1 & 1, c >> 2, unused), v[c], 1e-14);
    const double x = uniform(random), y = uniform(random), z = uniform(random), h = 0.1;
    double sum = 0;
    for (int c = 0; c < 8; ++c)
      sum += v[c] * (c & 1 ? x : 1 - x) * (c >> 1 & 1 ? y : 1 - y) * (c >> 2 ? z : 1 - z);
    EXPECT_NEAR(at(x, y, z, gradient), sum, 1e-14);
    // The interpolant is linear along each axis, so central differences are exact for any h.
    EXPECT_NEAR(gradient.x, (at(x + h, y, z, unused) - at(x - h, y, z, unused)) / (2 * h), 1e-12);
    EXPECT_NEAR(gradient.y, (at(x, y + h, z, unused) - at(x, y - h, z, unused)) / (2 * h), 1e-12);
    EXPECT_NEAR(gradient.z, (at(x, y, z + h, unused) - at(x, y, z - h, unused)) / (2 * h), 1e-12);
  }
}

// Distance field of a plane across a row of three bricks, of which only the middle one stores samples.
DistanceField planeField() {
  DistanceField field;
  field.grid = {{-0.012f, 0, 0}, 0.001f, {3, 1, 1}, 0.003f, 1e-6f, 0, 0, 0};
  field.index = {kInsideBrick, 0, kOutsideBrick};
  field.samples.resize(kBrickWords);
  for (uint32_t n = 0; n < kBrickSamples; ++n) {
    const auto stored = static_cast<uint16_t>(1000 * (static_cast<int>(n % kBrickSide) - 4));
    field.samples[n / 2] |= uint32_t{stored} << (16 * (n % 2));
  }
  for (int corner = 0; corner < 16; ++corner)
    field.corners.push_back(0.008f * static_cast<float>(corner % 4) - 0.012f);
  return field;
}

TEST(DistanceField, TellsTheDistanceToAPlaneFromItsArrays) {
  const DistanceField field = planeField();
  EXPECT_EQ(field.storedBricks(), 1u);
  EXPECT_EQ(field.bytes(), sizeof(FieldGrid) + 4u * (3 + kBrickWords + 16));
  for (const float x : {-0.0039f, -0.0037f, 0.0f, 0.00123f, 0.0039f}) {
    const FieldSample sample = field.at({x, 0.0031f, 0.0055f});
    EXPECT_NEAR(sample.distance, x, 1e-8);
    EXPECT_NEAR((sample.gradient - Vec3::UnitX()).norm(), 0, 1e-5);
  }
  for (const float x : {-0.011f, -0.006f, 0.005f, 0.0118f}) {
    const FieldSample sample = field.at({x, 0.004f, 0.004f});
    EXPECT_EQ(std::signbit(sample.distance), x < 0);
    EXPECT_LE(std::fabs(sample.distance), std::fabs(x)) << "far distances are lower bounds";
    EXPECT_GE(std::fabs(sample.distance), field.grid.band);
    EXPECT_NEAR((sample.gradient - Vec3::UnitX()).norm(), 0, 1e-5) << "the way out is known everywhere";
  }
}

TEST(DistanceField, AnyPointHasAnAnswer) {
  const DistanceField field = planeField();
  const FieldSample beside = field.at({0, -3, 0.004f});
  EXPECT_NEAR(beside.distance, 3.003f, 1e-5);
  EXPECT_NEAR((beside.gradient + Vec3::UnitY()).norm(), 0, 1e-6);
  for (const float bad : {NAN, INFINITY, -INFINITY, 1e30f}) {
    field.at({bad, 0, 0});
    field.at({0, bad, bad});
  }
}

}  // namespace
}  // namespace strandcast
