// Culling: groups of hair that cannot be in the picture, and hairs by level of detail.
#include <numbers>

#include "lamp.h"
#include "offscreen.h"
#include "render/hair_selection.h"
#include "render/shader_validation.h"

namespace strandcast {
namespace {

class Culling : public OffscreenTest {
 protected:
  /// A field of hair of 2 m, with shadows cast sideways.
  Culling() : groom_(verticalBundle(40, 40, 0.05f, 0.1f, 0.2f, 8)) {
    settings_ = smallPicture();
    settings_.growth.hairs = 6000;
    settings_.hair_width = 0.002f;
    settings_.detail = {1, 0, 0, 0};
    settings_.lights[0].direction = Vec3(1, -0.3f, 0);
  }
  RenderStatistics draw(const Camera& camera, Image& image) const {
    Renderer renderer(settings_);
    renderer.setGroom(groom_);
    renderer.draw(restFrame(groom_), camera);
    image = renderer.read();
    return renderer.statistics();
  }
  static Camera from(const Vec3& eye, const Vec3& target) { return {eye, target, 0.5f}; }

  GroomDescription groom_;
  RenderSettings settings_;
};

TEST_F(Culling, LeavesOutOnlyWhatThePictureWouldNotShow) {
  const RenderSettings usual = settings_;
  for (const Camera& camera :
       {from(Vec3(0.3f, 0.2f, 0.9f), Vec3(0.5f, 0, 0.4f)), from(Vec3(0, 0.05f, 0), Vec3(1, 0, 0)),
        from(Vec3(-1, 0.5f, -1), Vec3(-0.9f, 0, -0.9f)), from(Vec3(0, 3, 6), Vec3(0, 0, 0))}) {
    settings_.shadows = false;
    Image bare[2];
    for (const bool cull : {false, true}) {
      settings_.cull = cull;
      draw(camera, bare[cull]);
    }
    EXPECT_EQ(bare[0].rgb, bare[1].rgb);
    settings_.shadows = true;
    for (const auto& [path, light] :
         {std::pair{GrowthPath::kCompute, settings_.lights[0]},
          {GrowthPath::kTessellator, settings_.lights[0]},
          {GrowthPath::kCompute, pointLight(Vec3(-0.4f, 0.3f, 0.2f), 0.5f)},
          {GrowthPath::kCompute, spotLight(Vec3(-1.5f, 0.8f, 0), Vec3(1, -0.4f, 0), 0.4f, 4)}}) {
      settings_.growth_path = path;
      settings_.lights = {light};
      Image all, culled;
      settings_.cull = false;
      const RenderStatistics every = draw(camera, all);
      settings_.cull = true;
      const RenderStatistics some = draw(camera, culled);
      // The light accumulates hairs in a different order, in half floats.
      int worst = 0;
      for (size_t i = 0; i < all.rgb.size(); ++i)
        worst = std::max(worst, std::abs(all.rgb[i] - culled.rgb[i]));
      EXPECT_LE(worst, 2);
      EXPECT_EQ(every.groups_seen, some.groups_seen);
      EXPECT_EQ(every.hairs_computed, 6000u);
      EXPECT_EQ(every.hairs_drawn, 6000u);
      if (camera.eye.y() > 2) {
        EXPECT_EQ(some.hairs_drawn, 6000u) << "everything is in this one";
      } else {
        EXPECT_LT(some.hairs_drawn, 3500u);
        EXPECT_GE(some.hairs_computed, some.hairs_drawn);
        EXPECT_LT(some.groups_seen, some.groups);
      }
    }
    settings_ = usual;
  }
}

TEST_F(Culling, HairBesideThePictureStillShadesIt) {
  // Looks along x at the far end; the light comes from behind the eye, at a low elevation.
  const Camera camera = from(Vec3(0.6f, 0.3f, 0), Vec3(0.9f, -0.1f, 0));
  Image image;
  RenderStatistics with = draw(camera, image);
  EXPECT_GT(with.hairs_computed, with.hairs_drawn + 100);
  settings_.shadows = false;
  RenderStatistics without = draw(camera, image);
  EXPECT_EQ(without.hairs_computed, without.hairs_drawn);
  EXPECT_EQ(without.hairs_drawn, with.hairs_drawn);
}

TEST_F(Culling, HairShadesThePictureFromTheSideOfEachLight) {
  const Camera camera = from(Vec3(0, 0.3f, 0.4f), Vec3(0, -0.1f, 0));
  Light other = settings_.lights[0];
  other.direction.x() *= -1;
  Image image, all;
  const RenderStatistics one = draw(camera, image);
  settings_.lights.push_back(other);
  const RenderStatistics two = draw(camera, image);
  EXPECT_GT(two.hairs_computed, one.hairs_computed + 100);
  settings_.cull = false;
  draw(camera, all);
  int worst = 0;
  for (size_t i = 0; i < all.rgb.size(); ++i) worst = std::max(worst, std::abs(all.rgb[i] - image.rgb[i]));
  EXPECT_LE(worst, 2) << "half floats, added up in another order";
}

TEST_F(Culling, WhatIsBehindTheEyeCostsNothing) {
  settings_.shadows = false;
  Image image;
  const RenderStatistics statistics = draw(from(Vec3(0, 0, 2), Vec3(0, 0, 3)), image);
  EXPECT_EQ(statistics.hairs_grown, 6000u);
  EXPECT_EQ(statistics.hairs_drawn, 0u);
  EXPECT_EQ(statistics.hairs_computed, 0u);
  EXPECT_EQ(statistics.groups_seen, 0u);
  EXPECT_GT(statistics.groups, 20u);
}

TEST_F(Culling, BoxesOfGroupsHoldTheirHairs) {
  settings_.growth.curl_radius = 0.01f;
  settings_.growth.tip_deviation = 0.02f;
  std::vector<Vec3> rings;
  for (int i = 0; i < 40; ++i) {
    const float turn = 0.6f * static_cast<float>(i);
    rings.emplace_back(0.15f * std::sin(turn), -0.01f * static_cast<float>(i), 0.15f * std::cos(turn));
  }
  settings_.growth.curl_example = std::make_shared<const CurlExample>(curlOf(rings, "rings"));
  GroomDescription wild = groom_;
  for (size_t v = 0; v < wild.guides.positions.size(); ++v)
    wild.guides.positions[v] += 0.02f * Vec3(std::sin(5.0f * v), std::sin(7.0f * v), std::sin(11.0f * v));
  GuideNodes nodes(16);
  nodes.setGroom(groom_.guides);
  nodes.update(wild.guides.positions, Pose{});
  HairPass pass(GrowthPath::kCompute, HairGeometry::kLines);
  pass.setHairs(growHairs(groom_.guides, settings_.growth), settings_.growth);
  pass.grow(nodes, pass.all());
  HairGroups groups(groom_.guides, pass.hairs(), settings_.growth);
  EXPECT_GT(groups.reach(), groups.meanReach());
  EXPECT_GT(groups.meanReach(), 0.5f * settings_.growth.curl_radius);
  groups.place(wild.guides.positions, PlausibleBounds(groom_.guides.positions), 0);
  for (const GrownVertex& vertex : readComputed(pass, nodes, 1))
    ASSERT_TRUE(groups.box(groups.groupOf(vertex.hair)).contains(Eigen::Vector3f(vertex.position)));
}

TEST_F(Culling, DetailHoldsStillWhileTheSizeWavers) {
  HysteresisSize held;
  const float first = held.of(1, 0.1f);
  EXPECT_NEAR(first, 1.1f, 1e-6f);
  for (const float size : {0.95f, 1.09f, 1.0f, 0.92f}) EXPECT_EQ(held.of(size, 0.1f), first);
  EXPECT_NEAR(held.of(1.2f, 0.1f), 1.32f, 1e-6f) << "grows at once: never too coarse";
  EXPECT_NEAR(held.of(1.0f, 0.1f), 1.1f, 1e-6f) << "and falls where it leaves the band";
  for (const float size : {1.0f, 3.0f, 0.5f}) EXPECT_EQ(HysteresisSize().of(size, 0), size);

  settings_.detail = {0, 0, 0.1f, 1};
  settings_.hair_width = 2e-4f;
  settings_.segments = 64;
  const auto changes = [&](float hysteresis) {
    settings_.detail.hysteresis = hysteresis;
    Renderer renderer(settings_);
    renderer.setGroom(groom_);
    size_t hairs = 0;
    int segments = 0, changed = -1;
    for (int picture = 0; picture < 12; ++picture) {
      const float wavers = 1 + 0.02f * static_cast<float>(picture % 2);
      renderer.draw(restFrame(groom_), from(Vec3(0, 0.5f, 4 * wavers), Vec3::Zero()));
      const RenderStatistics now = renderer.statistics();
      changed += now.hairs_drawn != hairs || now.segments_drawn != segments;
      hairs = now.hairs_drawn;
      segments = now.segments_drawn;
    }
    return changed;
  };
  EXPECT_GE(changes(0), 10);
  EXPECT_LE(changes(0.1f), 1);
}

/// Mean difference from another picture over the pixels that differ from a bare one, relative to white.
double meanDifference(const Image& image, const Image& other, const Image& bare, int from_x, int to_x) {
  double sum = 0;
  int covered = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = from_x; x < to_x; ++x) {
      if (std::abs(linearValue(other, x, y, 1) - linearValue(bare, x, y, 1)) < 0.002) continue;
      sum += std::abs(linearValue(image, x, y, 1) - linearValue(other, x, y, 1));
      ++covered;
    }
  EXPECT_GT(covered, 500);
  return sum / std::max(covered, 1);
}

TEST_F(Culling, APictureThatHysteresisHoldsIsAsGoodAsOneThatComesAnew) {
  settings_.hair_width = 3e-4f;
  settings_.growth.hairs = 12000;
  settings_.detail = {0, 0, 0.3f, 1};
  const auto camera = [](float distance) { return from(Vec3(0, 0.15f * distance, distance), Vec3::Zero()); };
  const auto picture = [&](float before) {  // `before`: camera distance of the picture drawn first
    Renderer renderer(settings_);
    renderer.setGroom(groom_);
    renderer.draw(restFrame(groom_), camera(before));
    renderer.draw(restFrame(groom_), camera(3));
    return std::pair{renderer.read(), renderer.statistics().hairs_drawn};
  };
  // After a slightly nearer picture the finer level is held; after a distant one the level is chosen anew.
  const auto [held, held_hairs] = picture(2.75f);
  const auto [fresh, fresh_hairs] = picture(6);
  EXPECT_GT(held_hairs, fresh_hairs * 21 / 20);
  settings_.detail = {1, 0, 0, 0};
  const auto [full, full_hairs] = picture(3);
  EXPECT_GT(full_hairs, held_hairs);
  settings_.passes = {RenderPass::kBackground, RenderPass::kGround, RenderPass::kResolve};
  const Image bare = picture(3).first;
  EXPECT_LT(meanDifference(held, full, bare, 0, 128), 0.02);
  EXPECT_LT(meanDifference(fresh, full, bare, 0, 128), 0.02);
}

TEST_F(Culling, WhereTheImportanceMapIsDarkThePictureIsCoarserAndTheRestAsItWas) {
  settings_.lights[0].direction = Vec3(0, -1, -1);
  settings_.growth.hairs = 12000;
  settings_.hair_width = 6e-4f;
  settings_.samples = 1;
  settings_.cull = false;
  for (size_t g = 0; g < groom_.guides.strands(); ++g)
    groom_.guides.uvs.push_back(Vec2(groom_.guides.strand(g).front().x() < 0 ? 0.25f : 0.75f, 0.5f));
  const auto white = std::make_shared<ScalpMap>(ScalpMap{2, 1, {1, 1}}),
             half = std::make_shared<ScalpMap>(ScalpMap{2, 1, {1, 0.1f}});
  const std::vector<RenderPass> passes = settings_.passes;
  const Camera camera = from(Vec3(0, 0.5f, 3), Vec3::Zero());
  double all = 0, left = 0;
  for (const uint64_t seed : {1, 2, 3, 4, 5, 6}) {
    settings_.growth.seed = seed;
    Image full, bare, mapped;
    settings_.passes = {RenderPass::kBackground, RenderPass::kGround, RenderPass::kResolve};
    draw(camera, bare);
    settings_.passes = passes;
    settings_.growth.importance = white;
    settings_.detail = {1, 0, 0, 0};
    draw(camera, full);
    settings_.growth.importance = half;
    settings_.detail = {0.1f, 0, 0, 0};
    EXPECT_NEAR(static_cast<double>(draw(camera, mapped).hairs_drawn), 1200, 2);
    // The white half of the map is the left one of the picture: hairs left out there cover no sample.
    EXPECT_LT(meanDifference(mapped, full, bare, 0, 60), 0.01);
    EXPECT_GT(meanDifference(mapped, full, bare, 68, 128), 0.02);
    for (int y = 0; y < 128; ++y)
      for (int x = 68; x < 128; ++x) {
        all += linearValue(full, x, y, 1) - linearValue(bare, x, y, 1);
        left += linearValue(mapped, x, y, 1) - linearValue(bare, x, y, 1);
      }
  }
  EXPECT_NEAR(left / all, 1, 0.1) << "fewer hairs cover as much";
}

TEST_F(Culling, WhereTheImportanceMapIsDarkHairsGoFirstAndTheRestGrowsWider) {
  const auto map = std::make_shared<ScalpMap>();
  map->width = 2;
  map->height = 1;
  map->values = {1, 0.1f};
  HairGrowth growth = settings_.growth;
  growth.importance = map;
  for (size_t g = 0; g < groom_.guides.strands(); ++g)  // the map's left half is at negative x
    groom_.guides.uvs.push_back(Vec2(groom_.guides.strand(g).front().x() < 0 ? 0.25f : 0.75f, 0.5f));
  const std::vector<Hair> hairs = growHairs(groom_.guides, growth),
                          even = growHairs(groom_.guides, settings_.growth);
  ASSERT_EQ(hairs.size(), even.size());
  const HairDetail detail = detailOfPart(hairs, 0.4f);
  size_t dark = 0, light = 0;
  double area_left = 0, area = 0;
  for (size_t i = 0; i < hairs.size(); ++i) {
    area += static_cast<double>(hairs[i].width);
    if (i >= detail.hairs) continue;
    (hairs[i].importance < 0.5f ? dark : light) += 1;
    const double chance =
        std::min(1.0, static_cast<double>(detail.threshold * hairs[i].width * hairs[i].importance));
    area_left += static_cast<double>(hairs[i].width) / chance;
  }
  EXPECT_GT(light, 5 * dark);
  EXPECT_GT(dark, 50u);
  EXPECT_NEAR(area_left / area, 1, 0.06) << "as much is covered";
}

}  // namespace
}  // namespace strandcast
