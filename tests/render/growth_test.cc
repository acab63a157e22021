#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "render/hair_growth.h"
#include "render/hair_selection.h"
#include "render/scalp.h"
#include "render/shader_validation.h"

namespace strandcast {
namespace {

using Vec = Eigen::Vector3d;

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

bool followsOne(const Hair& hair) { return hair.weights[0] == 0 && hair.weights[1] == 0; }

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

TEST(HairGrowth, TheFirstGuideIsTheNearestAndBothWaysOfInterpolatingOccur) {
  const StrandSet guides = grid(8, 0.01f, up);
  size_t single = 0, several = 0;
  for (const Hair& hair : growHairs(guides, {.hairs = 2000})) {
    for (const float weight : hair.weights) EXPECT_GE(weight, 0);
    EXPECT_LE(hair.weights[0] + hair.weights[1], 2.0f / 3 + 1e-6f);  // guide 0 is the nearest
    for (const uint32_t guide : hair.guides) EXPECT_LT(guide, guides.strands());
    (followsOne(hair) ? single : several) += 1;
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
  const HairGrowth growth{.hairs = 16000, .clump_radius = 0.001f};
  const HairReference grown(guides, guides.positions, 1);
  for (const Hair& hair : growHairs(guides, growth)) {
    const Vec root = grown.at(hair, growth, 0).position;
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
  const HairGrowth growth{.hairs = 4000, .clump_radius = 0.0005f};
  const HairReference grown(guides, guides.positions, 1);
  for (const Hair& hair : growHairs(guides, growth)) {
    for (const uint32_t guide : hair.guides)
      EXPECT_EQ(hair.guides[0] % side < side / 2, guide % side < side / 2);
    // The component along the guide is dropped, so an offset across the parting remains as one in height.
    const Vec off = grown.at(hair, growth, 0).position - guides.strand(hair.guides[0]).front().cast<double>();
    if (followsOne(hair) && off.norm() > 0.001) ++on_the_part;
  }
  EXPECT_GT(on_the_part, 50u);
}

TEST(HairGrowth, AtAPartingRootsStayWhereTheyAreWhateverALocksProfile) {
  const int side = 8;
  const StrandSet guides =
      grid(side, 0.01f, [](int x, int) { return Vec3(x < side / 2 ? -1 : 1, 0.2f, 0).normalized(); });
  const HairReference grown(guides, guides.positions, 4);
  HairGrowth growth{.hairs = 4000, .clump_radius = 1e-6f, .tip_deviation = 0, .whole_deviation = 0};
  growth.lock_profile = {1, 1, 1};
  const std::vector<Hair> even = growHairs(guides, growth);
  size_t beside = 0;
  for (const Vec3& profile : {Vec3(0, 0, 0), Vec3(3, 1, 0)}) {
    HairGrowth other = growth;
    other.lock_profile = profile;
    const std::vector<Hair> hairs = growHairs(guides, other);
    ASSERT_EQ(hairs.size(), even.size());
    for (size_t i = 0; i < hairs.size(); ++i) {
      beside += std::hypot(hairs[i].beside[0], hairs[i].beside[1]) > 0.001f;
      for (const int node : {0, 2, 4})
        EXPECT_LT(
            (grown.at(hairs[i], other, node).position - grown.at(even[i], growth, node).position).norm(),
            1e-5);
    }
  }
  EXPECT_GT(beside, 100u);
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

TEST(HairGrowth, EachKindOfInterpolationFollowsAsManyGuidesAsItShould) {
  const StrandSet guides = grid(8, 0.01f, up);
  for (const Hair& hair : growHairs(guides, {.hairs = 500, .interpolation = Interpolation::kMultiStrand})) {
    EXPECT_FALSE(followsOne(hair));
    EXPECT_EQ(hair.clump, 0);
  }
  for (const Hair& hair : growHairs(guides, {.hairs = 500, .interpolation = Interpolation::kSingleStrand})) {
    EXPECT_TRUE(followsOne(hair));
    EXPECT_EQ(hair.clump, 0);
  }
}

TEST(HairGrowth, DeviationsAreOnTheirPartOfTheHairsAndLeaveTheRestAsItWas) {
  const StrandSet guides = grid(8, 0.01f, up);
  const std::vector<Hair> with = growHairs(guides, {.hairs = 5000});
  const std::vector<Hair> without =
      growHairs(guides, {.hairs = 5000, .tip_deviation = 0, .whole_deviation = 0});
  ASSERT_EQ(with.size(), without.size());
  int tip = 0, whole = 0;
  for (size_t i = 0; i < with.size(); ++i) {
    tip += with[i].tip_deviation > 0;
    whole += with[i].whole_deviation > 0;
    EXPECT_EQ(without[i].tip_deviation, 0);
    Hair same = with[i];
    same.tip_deviation = same.whole_deviation = 0;
    EXPECT_EQ(std::memcmp(&same, &without[i], sizeof(Hair)), 0);
  }
  EXPECT_NEAR(tip, 1500, 150);
  EXPECT_NEAR(whole, 500, 100);
}

TEST(HairGrowth, MapsThinOutHairAndMakeItThinner) {
  StrandSet guides = grid(9, 0.01f, up);
  for (size_t g = 0; g < guides.strands(); ++g)
    guides.uvs.emplace_back((0.5f + static_cast<float>(g % 9)) / 9, (0.5f + static_cast<float>(g / 9)) / 9);
  const auto halves = std::make_shared<const ScalpMap>(ScalpMap{2, 1, {1.0f, 0.25f}});
  HairGrowth growth{.hairs = 8000, .clump_radius = 0.0005f};
  const std::vector<Hair> all = growHairs(guides, growth);
  growth.density = growth.thickness = halves;
  const std::vector<Hair> mapped = growHairs(guides, growth);
  const ScalpPlaces places(guides);
  // The map is constant in the middle of each half.
  const auto count = [&](const std::vector<Hair>& hairs, float from, float to, double& width) {
    double number = 0;
    for (const Hair& hair : hairs) {
      const float x = places.of(hair.guides, hair.weights).x();
      if (x < from || x > to) continue;
      ++number;
      width += hair.width;
    }
    width /= number;
    return number;
  };
  double width[4] = {};
  const double left = count(all, 0.2f, 0.3f, width[0]), right = count(all, 0.7f, 0.8f, width[1]);
  EXPECT_NEAR(count(mapped, 0.2f, 0.3f, width[2]) / left, 0.96, 0.06);
  EXPECT_NEAR(count(mapped, 0.7f, 0.8f, width[3]) / right, 0.29, 0.06);
  EXPECT_NEAR(width[2], 1, 0.08);
  EXPECT_NEAR(width[3], 0.29, 0.06);
}

TEST(HairGrowth, WhereAHairIsInAPixelDoesNotFollowFromHowLongItStays) {
  const std::vector<Hair> hairs = growHairs(grid(9, 0.01f, up), {.hairs = 200000});
  const size_t last = hairs.size() / 200;  // of a small picture
  int count[4] = {};
  for (size_t i = 0; i < last; ++i) ++count[static_cast<int>(4 * hairs[i].first_sample)];
  for (const int n : count) EXPECT_NEAR(n, static_cast<double>(last) / 4, 60);
}

TEST(HairGrowth, WhatAMapMakesOfNoWidthDoesNotGrow) {
  const StrandSet guides = grid(9, 0.01f, up);
  HairGrowth growth{.hairs = 2000};
  growth.thickness = std::make_shared<const ScalpMap>(ScalpMap{4, 1, {1, 0, 0, 1}});
  const std::vector<Hair> hairs = growHairs(guides, growth);
  EXPECT_GT(hairs.size(), 500u);
  EXPECT_LT(hairs.size(), 1500u);
  for (const Hair& hair : hairs) EXPECT_GT(hair.width, 0);
  growth.thickness = std::make_shared<const ScalpMap>(ScalpMap{1, 1, {0}});
  EXPECT_TRUE(growHairs(guides, growth).empty());
}

TEST(ScalpMap, IsBilinearAndItsSidesMeet) {
  const ScalpMap map{4, 2, {0, 1, 2, 3, 4, 5, 6, 7}};
  EXPECT_FLOAT_EQ(map.at(Vec2(0.125f, 0.25f)), 0);
  EXPECT_FLOAT_EQ(map.at(Vec2(0.25f, 0.25f)), 0.5f);
  EXPECT_FLOAT_EQ(map.at(Vec2(0.125f, 0.5f)), 2);
  EXPECT_FLOAT_EQ(map.at(Vec2(0.375f, 1.0f)), 5);
  EXPECT_FLOAT_EQ(map.at(Vec2(0.0f, 0.0f)), 1.5f);
  EXPECT_FLOAT_EQ(map.at(Vec2(1.0f, 0.0f)), 1.5f);
}

TEST(ScalpMap, RootsWithoutUvsLieByLongitudeAndLatitude) {
  StrandSet guides;
  for (const Vec3& root :
       {Vec3(0, 0, 1), Vec3(0, 0, -1), Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0)})
    guides.append(std::vector<Vec3>{root, Vec3(2 * root)});
  const ScalpPlaces places(guides);
  const auto at = [&](uint32_t g) { return places.of({g, g, g}, {0, 0}); };
  EXPECT_NEAR((at(0) - Vec2(0.5f, 0.5f)).norm(), 0, 1e-5);
  EXPECT_NEAR((at(2) - Vec2(0.75f, 0.5f)).norm(), 0, 1e-5);
  EXPECT_NEAR((at(3) - Vec2(0.25f, 0.5f)).norm(), 0, 1e-5);
  EXPECT_NEAR(at(4).y(), 0, 1e-3);
  EXPECT_NEAR(at(5).y(), 1, 1e-3);
}

/// As hair_vertex.glsl: the drawn width over the hair's own, and the remaining dither.
std::pair<double, double> drawnWidth(const Hair& hair, const HairDetail& detail) {
  const double chance = std::min(static_cast<double>(detail.threshold) * hair.width, 1.0);
  return {1 / chance, (hair.dither - 1 + chance) / chance};
}

TEST(HairDetail, AnyPartOfTheHairsCoversAsMuchAsAll) {
  const std::vector<Hair> hairs = growHairs(grid(8, 0.01f, up), {.hairs = 20000});
  double all = 0;
  for (const Hair& hair : hairs) all += hair.width;
  for (const float part : {0.01f, 0.1f, 0.3f, 0.7f, 0.95f, 1.0f}) {
    const HairDetail detail = detailOfPart(hairs, part);
    EXPECT_NEAR(static_cast<double>(detail.hairs), 20000.0 * part, 1);
    double drawn = 0;
    for (size_t i = 0; i < hairs.size(); ++i) {
      const auto [factor, left] = drawnWidth(hairs[i], detail);
      if (i < detail.hairs) {
        drawn += factor * hairs[i].width;
      } else {
        ASSERT_LE(left, 1e-3) << "a hair that is left out would not be drawn";
      }
    }
    EXPECT_NEAR(drawn / all, 1, 0.02) << part;
  }
  EXPECT_EQ(detailOfPart({}, 0.5f).hairs, 0u);
}

TEST(HairDetail, ByTheirSizeJustThoseAreLeftOutThatReachNoSample) {
  const std::vector<Hair> hairs = growHairs(grid(8, 0.01f, up), {.hairs = 5000});
  for (const float pixels : {0.001f, 0.03f, 0.1f, 0.2f, 3.0f}) {
    const HairDetail detail = detailOfSize(hairs, pixels, 0.25f);
    size_t drawn = 0;
    for (size_t i = 0; i < hairs.size(); ++i) {
      // At its nearest point, and at twice the distance.
      for (const double nearer : {1.0, 0.5}) {
        const double coverage = 4 * pixels * nearer * hairs[i].width;
        const double full = std::floor(coverage + hairs[i].dither);
        const auto [factor, left] = drawnWidth(hairs[i], detail);
        const double less = i < detail.hairs ? std::floor(coverage * factor + left + 1e-5) : 0;
        EXPECT_EQ(full > 0, less > 0) << "hair " << i << " at " << pixels;
        drawn += nearer == 1.0 && less > 0;
      }
    }
    EXPECT_NEAR(static_cast<double>(drawn), static_cast<double>(detail.hairs), 10.0) << pixels;
  }
}

TEST(HairDetail, SegmentsAreLeftOutWhileTheyStayShort) {
  EXPECT_EQ(strideFor(3, 4, 32, 4), 1);
  EXPECT_EQ(strideFor(2, 4, 32, 4), 2);
  EXPECT_EQ(strideFor(0.1f, 4, 32, 8), 4);
  EXPECT_EQ(strideFor(0.1f, 4, 7, 8), 1);
  EXPECT_EQ(strideFor(0.1f, 0, 32, 1), 1);
}

}  // namespace
}  // namespace strandcast
