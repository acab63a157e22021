#include "groom/hair_binding.h"

#include <gtest/gtest.h>

#include <random>

#include "core/error.h"
#include "groom/groom_operations.h"

namespace strandcast {
namespace {

/// A hair from `root` in a direction, with `vertices` vertices, m.
std::vector<Vec3> straight(const Vec3& root, const Vec3& direction, float length = 0.2f,
                           size_t vertices = 8) {
  std::vector<Vec3> points;
  for (size_t i = 0; i < vertices; ++i)
    points.push_back(root + direction.normalized() *
                                (length * static_cast<float>(i) / static_cast<float>(vertices - 1)));
  return points;
}

/// Hairs on a patch of 10 cm that fall and lean at random.
StrandSet patch(size_t hairs, uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(-1, 1);
  StrandSet strands;
  for (size_t s = 0; s < hairs; ++s) {
    const Vec3 root(0.05f * unit(random), 0, 0.05f * unit(random));
    const Vec3 direction(0.3f * unit(random), -1, 0.3f * unit(random));
    strands.append(straight(root, direction, 0.2f + 0.05f * unit(random), 5 + s % 7));
  }
  return strands;
}

bool equal(const HairBinding& a, const HairBinding& b) {
  return a.guides == b.guides && a.weights == b.weights;
}

TEST(HairBinding, AHairThatIsAGuideFollowsItAlone) {
  const StrandSet hairs = patch(300, 1);
  const std::vector<uint32_t> chosen = chooseGuides(hairs, 20);
  const std::vector<HairBinding> bindings = bindHairs(hairs, subset(hairs, chosen));
  ASSERT_EQ(bindings.size(), 300u);
  for (uint32_t g = 0; g < chosen.size(); ++g) {
    const HairBinding& binding = bindings[chosen[g]];
    EXPECT_EQ(binding.guides[0], g);
    EXPECT_EQ(binding.weight(0), 1);
  }
}

TEST(HairBinding, WeightsDescendAndSumToOne) {
  const StrandSet hairs = patch(500, 2), guides = patch(25, 3);
  size_t blended = 0;
  for (const HairBinding& binding : bindHairs(hairs, guides)) {
    EXPECT_LE(binding.weights[0] + binding.weights[1], 255);
    EXPECT_NEAR(binding.weight(0) + binding.weight(1) + binding.weight(2), 1, 1e-12);
    // Rounding moves the first by 1 / 255 at most.
    EXPECT_GE(255 * binding.weight(0) + 1.5, binding.weights[0]);
    EXPECT_GE(binding.weights[0], binding.weights[1]);
    for (size_t k = 0; k < 3; ++k) EXPECT_LT(binding.guides[k], 25u);
    for (size_t k = 1; k < 3; ++k)
      EXPECT_EQ(binding.weights[k - 1] == 0, binding.guides[k] == binding.guides[0]);
    blended += binding.weights[1] > 0;
  }
  EXPECT_GT(blended, 400u);
}

TEST(HairBinding, AHairFollowsTheGuidesWithItsShapeNotTheNearestRoot) {
  StrandSet guides;
  guides.append(straight({0.001f, 0, 0}, {1, -1, 0}));
  guides.append(straight({0.010f, 0, 0}, {0, -1, 0}));
  StrandSet hair;
  hair.append(straight({0, 0, 0}, {0, -1, 0.05f}));
  EXPECT_EQ(bindHairs(hair, guides)[0].guides[0], 1u);
}

TEST(HairBinding, NoHairFollowsGuidesOnBothSidesOfAParting) {
  StrandSet guides, hairs;
  for (int i = 0; i < 6; ++i) {
    const float z = 0.01f * static_cast<float>(i);
    guides.append(straight({-0.005f, 0, z}, {-1, -0.3f, 0}));
    guides.append(straight({0.005f, 0, z}, {1, -0.3f, 0}));
    hairs.append(straight({-0.002f, 0, z + 0.004f}, {-1, -0.35f, 0}));
    hairs.append(straight({0.002f, 0, z + 0.004f}, {1, -0.35f, 0}));
  }
  const std::vector<HairBinding> bindings = bindHairs(hairs, guides);
  for (size_t s = 0; s < bindings.size(); ++s) {
    EXPECT_GT(bindings[s].weights[0], 0);
    for (const uint32_t g : bindings[s].guides) EXPECT_EQ(g % 2, s % 2) << "hair " << s;
  }
}

TEST(HairBinding, AShortHairLeavesOutGuidesThreeTimesAsLongAsItsFirst) {
  StrandSet guides, hair;
  guides.append(straight({0, 0, 0}, {0, -1, 0}, 0.02f));
  guides.append(straight({0.001f, 0, 0}, {0, -1, 0}, 0.1f));
  hair.append(straight({0.0002f, 0, 0}, {0, -1, 0}, 0.02f));
  const HairBinding binding = bindHairs(hair, guides)[0];
  EXPECT_EQ(binding.guides, (std::array<uint32_t, 3>{0, 0, 0}));
  EXPECT_EQ(binding.weight(0), 1);
}

TEST(HairBinding, ALongHairFollowsAFarShorterGuideOnlyWhereThereIsNoOther) {
  StrandSet guides, hair;
  guides.append(straight({0.001f, 0, 0}, {0, -1, 0}, 0.01f));
  hair.append(straight({0, 0, 0}, {0, -1, 0}, 0.05f));
  EXPECT_EQ(bindHairs(hair, guides)[0].guides[0], 0u);
  guides.append(straight({0.04f, 0, 0}, {1, -1, 0}, 0.05f));  // at a greater distance
  const HairBinding binding = bindHairs(hair, guides)[0];
  EXPECT_EQ(binding.guides[0], 1u);
  EXPECT_EQ(binding.weight(0), 1);
}

TEST(HairBinding, GuidesOfTheHairsPartAreTakenUnlessThereAreTooFew) {
  StrandSet hairs = patch(200, 4), guides = patch(30, 5);
  hairs.parts.assign(200, 0);
  for (size_t s = 0; s < 200; ++s) hairs.parts[s] = static_cast<uint16_t>(s % 3);
  for (size_t g = 0; g < 30; ++g) guides.parts.push_back(g < 2 ? 2 : static_cast<uint16_t>(g % 2));
  const std::vector<HairBinding> bindings = bindHairs(hairs, guides);
  bool others = false;
  for (size_t s = 0; s < 200; ++s)
    for (const uint32_t g : bindings[s].guides) {
      EXPECT_TRUE(hairs.parts[s] == 2 || guides.parts[g] == hairs.parts[s]) << "hair " << s;
      others |= hairs.parts[s] == 2 && guides.parts[g] != 2;
    }
  EXPECT_TRUE(others) << "part 2 has two guides only";
}

TEST(HairBinding, DependsOnTheHairAloneAndIsTheSameAgain) {
  const StrandSet hairs = patch(200, 6), guides = patch(40, 7);
  const std::vector<HairBinding> bindings = bindHairs(hairs, guides), again = bindHairs(hairs, guides);
  for (uint32_t s = 0; s < 200; ++s) {
    EXPECT_TRUE(equal(bindings[s], again[s]));
    EXPECT_TRUE(equal(bindings[s], bindHairs(subset(hairs, {s}), guides)[0])) << "hair " << s;
  }
}

TEST(HairBinding, FewerThanThreeGuidesAndStrandsOfOneVertex) {
  StrandSet hairs, guides;
  hairs.append(straight({0, 0, 0}, {0, -1, 0}));
  hairs.append(std::vector<Vec3>{Vec3(0.01f, 0, 0)});
  EXPECT_THROW(bindHairs(hairs, guides), Error);
  EXPECT_TRUE(bindHairs({}, guides).empty());
  guides.append(std::vector<Vec3>{Vec3(0.02f, 0, 0)});
  for (const HairBinding& binding : bindHairs(hairs, guides)) {
    EXPECT_EQ(binding.guides, (std::array<uint32_t, 3>{0, 0, 0}));
    EXPECT_EQ(binding.weight(0), 1);
  }
}

TEST(HairBinding, TheOrderByGuideKeepsHairsOfOneGuideAsTheyStand) {
  const std::vector<HairBinding> bindings{
      {{2, 2, 2}, {}}, {{0, 1, 0}, {9, 0}}, {{2, 0, 2}, {5, 0}}, {{0, 0, 0}, {}}};
  EXPECT_EQ(orderByGuide(bindings), (std::vector<uint32_t>{1, 3, 0, 2}));
}

}  // namespace
}  // namespace strandcast
