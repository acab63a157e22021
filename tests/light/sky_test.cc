#include "light/sky.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "light/random_stream.h"
#include "tests/expect_error.h"

namespace strandcast {
namespace {

/// A dim sky with a bright pixel of some colour.
FloatImage skyPicture(int width, int height, int x, int y) {
  FloatImage image{width, height, {{"B", {}}, {"G", {}}, {"R", {}}}, {}};
  for (FloatImage::Channel& channel : image.channels)
    channel.values.assign(static_cast<size_t>(width * height), 0.1f);
  image.channels[2].values[static_cast<size_t>(y * width + x)] = 50;
  return image;
}

TEST(Sky, SamplesFollowTheDensityAndGiveTheMeanRadiance) {
  const Sky skies[] = {Sky::constant({1, 2, 3}), Sky::ambient(),
                       Sky::picture(skyPicture(16, 8, 3, 2), 2, "a picture")};
  for (const Sky& sky : skies) {
    SampleStream random(1, 2, 3);
    constexpr int kSamples = 200000;
    double whole = 0;
    Eigen::Array3d by_importance{0, 0, 0}, uniform{0, 0, 0};
    for (int i = 0; i < kSamples; ++i) {
      const Sky::Sample s = sky.sample(random.uniform(), random.uniform());
      ASSERT_NEAR(s.direction.norm(), 1, 1e-9);
      EXPECT_TRUE((s.radiance - sky.radiance(s.direction)).abs().maxCoeff() < 1e-6 ||
                  s.pdf != sky.pdf(s.direction));
      by_importance += s.radiance / s.pdf / kSamples;
      const double height = 1 - 2 * random.uniform(), phi = 2 * std::numbers::pi * random.uniform();
      const double r = std::sqrt(1 - height * height);
      const Eigen::Vector3d direction(r * std::cos(phi), height, r * std::sin(phi));
      whole += 4 * std::numbers::pi * sky.pdf(direction) / kSamples;
      uniform += 4 * std::numbers::pi * sky.radiance(direction) / kSamples;
    }
    EXPECT_NEAR(whole, 1, 0.03);
    const Eigen::Array3d wanted = 4 * std::numbers::pi * sky.mean();
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(by_importance[c], wanted[c], 0.01 * wanted[c]);
      EXPECT_NEAR(uniform[c], wanted[c], 0.03 * wanted[c]);
    }
  }
}

TEST(Sky, APictureHasUpInItsTopRowAndPlusZInItsMiddle) {
  const int width = 32, height = 16;
  const auto redAt = [&](int x, int y, const Eigen::Vector3d& direction) {
    return Sky::picture(skyPicture(width, height, x, y), 1, "p").radiance(direction.normalized())[0];
  };
  EXPECT_NEAR(redAt(16, 8, {0.05, -0.05, 1}), 50, 1e-4);
  EXPECT_NEAR(redAt(24, 8, {1, -0.05, -0.05}), 50, 1e-4);
  EXPECT_NEAR(redAt(8, 8, {-1, -0.05, 0.05}), 50, 1e-4);
  EXPECT_NEAR(redAt(16, 0, {0.001, 1, 0.01}), 50, 1e-4);
  EXPECT_NEAR(redAt(16, 0, {0.05, -0.05, 1}), 0.1, 1e-4);
}

TEST(Sky, ABlackOneGivesNoSamples) {
  EXPECT_TRUE(Sky().isBlack());
  EXPECT_EQ(Sky().sample(0.5, 0.5).pdf, 0);
  EXPECT_EQ(Sky().pdf(Eigen::Vector3d::UnitX()), 0);
}

TEST(Sky, RefusesWhatIsNoRadiance) {
  expectError([] { Sky::constant({1, -1, 0}); }, {"radiance of the sky is -1"});
  expectError([] { Sky::constant({1, std::nan(""), 0}); }, {"radiance of the sky is nan"});
  FloatImage image = skyPicture(4, 2, 1, 1);
  image.channels[1].values[5] = std::numeric_limits<float>::infinity();
  expectError([&] { Sky::picture(image, 1, "a.exr"); }, {"the sky is inf at pixel 1 1: a.exr"});
  image.channels[1].values[5] = -3;
  expectError([&] { Sky::picture(image, 1, "a.exr"); }, {"the sky is -3 at pixel 1 1: a.exr"});
  image.channels.pop_back();
  expectError([&] { Sky::picture(image, 1, "a.exr"); }, {"no channel R: a.exr"});
  expectError([] { Sky::readPicture("/nowhere/sky.exr", 1); }, {"cannot be read: /nowhere/sky.exr"});
}

}  // namespace
}  // namespace strandcast
