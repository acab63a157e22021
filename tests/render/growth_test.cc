#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "render/hair_growth.h"
#include "render/root_triangles.h"

namespace strandcast {
namespace {

StrandSet grid(int side, float spacing, auto&& direction) {
  StrandSet guides;
  for (int z = 0; z < side; ++z) {
    for (int x = 0; x < side; ++x) {
      const Vec3 root(spacing * x, 0, spacing * z), d = direction(x, z);
      const std::vector<Vec3> points{root, Vec3(root + 0.1f * d), Vec3(root + 0.2f * d)};
      guides.append(points);
    }
  }
  return guides;
}

Vec3 up(int, int) { return Vec3::UnitY(); }

Vec3 rootOf(const StrandSet& guides, const Hair& hair) {
  Vec3 root = Vec3::Zero();
  for (int k = 0; k < 3; ++k) root += hair.weights[k] * guides.strand(hair.guides[k]).front();
  const RootFrame frame = rootFrame(guides.strand(hair.guides[0]));
  return Vec3(root + hair.offset[0] * frame.normal + hair.offset[1] * frame.binormal);
}

TEST(HairGrowth, GrowsTheWantedNumberAndTheSameForTheSameSeed) {
  const StrandSet guides = grid(8, 0.01f, up);
  const HairGrowth growth{.hairs = 777, .seed = 5};
  const std::vector<Hair> a = growHairs(guides, growth), b = growHairs(guides, growth);
  ASSERT_EQ(a.size(), 777u);
  EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(Hair)), 0);
  HairGrowth other = growth;
  other.seed = 6;
  const std::vector<Hair> c = growHairs(guides, other);
  EXPECT_NE(std::memcmp(a.data(), c.data(), a.size() * sizeof(Hair)), 0);
}

TEST(HairGrowth, WeightsSumToOneAndBothWaysOfInterpolatingOccur) {
  const StrandSet guides = grid(8, 0.01f, up);
  size_t single = 0, several = 0;
  for (const Hair& hair : growHairs(guides, {.hairs = 2000})) {
    EXPECT_NEAR(hair.weights[0] + hair.weights[1] + hair.weights[2], 1, 1e-6);
    for (int k = 0; k < 3; ++k) {
      EXPECT_GE(hair.weights[k], 0);
      EXPECT_LT(hair.guides[k], guides.strands());
    }
    (hair.weights[0] == 1 ? single : several) += 1;
  }
  EXPECT_GT(single, 300u);
  EXPECT_GT(several, 1000u);
}

TEST(HairGrowth, RootsCoverTheAreaOfTheGuidesEvenly) {
  const int side = 9, cells = 4;
  const float spacing = 0.01f, width = spacing * (side - 1);
  const StrandSet guides = grid(side, spacing, up);
  int count[cells][cells] = {};
  int outside = 0;
  for (const Hair& hair : growHairs(guides, {.hairs = 16000, .clump_radius = 0.001f})) {
    const Vec3 root = rootOf(guides, hair);
    const int x = static_cast<int>(std::floor(root.x() / width * cells)),
              z = static_cast<int>(std::floor(root.z() / width * cells));
    if (x < 0 || z < 0 || x >= cells || z >= cells)
      ++outside;
    else
      ++count[x][z];
  }
  EXPECT_LT(outside, 16000 / 20);
  for (const auto& row : count)
    for (int n : row) EXPECT_NEAR(n, 1000, 350);
}

TEST(HairGrowth, DoesNotMixGuidesThatPartButGrowsHairBetweenThem) {
  const int side = 8;
  const float spacing = 0.01f;
  const StrandSet guides =
      grid(side, spacing, [](int x, int) { return Vec3(x < side / 2 ? -1 : 1, 0.2f, 0).normalized(); });
  size_t on_the_part = 0;
  for (const Hair& hair : growHairs(guides, {.hairs = 4000, .clump_radius = 0.0005f})) {
    for (int k = 1; k < 3; ++k) {
      if (hair.weights[k] > 0) {
        EXPECT_EQ(hair.guides[0] % side < side / 2, hair.guides[k] % side < side / 2);
      }
    }
    // Sliding along the guide is left out, so look across it: between the columns beside the part in height.
    const Vec3 off = rootOf(guides, hair) - guides.strand(hair.guides[0]).front();
    if (hair.weights[0] == 1 && off.norm() > 0.001f) ++on_the_part;
  }
  EXPECT_GT(on_the_part, 50u);
}

TEST(HairGrowth, LeavesOutGuidesThatAreNoCurves) {
  StrandSet guides = grid(6, 0.01f, up);
  guides.strand(7)[1].x() = std::numeric_limits<float>::quiet_NaN();
  for (Vec3& p : guides.strand(8)) p = guides.strand(8).front();
  guides.append(std::vector<Vec3>{Vec3(0.02f, 0, 0.02f)});
  const std::vector<Hair> hairs = growHairs(guides, {.hairs = 3000});
  ASSERT_EQ(hairs.size(), 3000u);
  for (const Hair& hair : hairs)
    for (uint32_t g : hair.guides) EXPECT_TRUE(g != 7 && g != 8 && g != guides.strands() - 1) << g;
}

TEST(HairGrowth, GrowsAroundOneGuideAndNothingWithoutGuides) {
  StrandSet one;
  one.append(std::vector<Vec3>{Vec3(0, 0, 0), Vec3(0, 1, 0)});
  const std::vector<Hair> hairs = growHairs(one, {.hairs = 100, .clump_radius = 0.01f});
  ASSERT_EQ(hairs.size(), 100u);
  for (const Hair& hair : hairs) {
    EXPECT_EQ(hair.guides[0], 0u);
    EXPECT_LE(std::hypot(hair.offset[0], hair.offset[1]), 0.01f + 1e-6f);
  }
  EXPECT_TRUE(growHairs({}, {.hairs = 100}).empty());
  EXPECT_TRUE(growHairs(one, {.hairs = 0}).empty());
}

TEST(HairGrowth, HairsThatReachASampleAreAPrefix) {
  const std::vector<Hair> hairs = growHairs(grid(8, 0.01f, up), {.hairs = 5000});
  for (float coverage : {0.01f, 0.1f, 0.3f, 2.0f}) {
    const size_t prefix = hairsReaching(hairs, coverage, 4);
    for (size_t i = prefix; i < hairs.size(); ++i)
      ASSERT_EQ(std::floor(coverage * hairs[i].width * 4 + hairs[i].dither), 0) << i;
    double reached = 0, wanted = 0;
    for (size_t i = 0; i < hairs.size(); ++i) {
      reached += std::floor(coverage * hairs[i].width * 4 + hairs[i].dither);
      wanted += coverage * hairs[i].width * 4;
    }
    EXPECT_NEAR(reached, wanted, 0.02 * wanted + 10) << coverage;
  }
  EXPECT_EQ(hairsReaching(hairs, 2.0f, 4), hairs.size());
}

}  // namespace
}  // namespace strandcast
