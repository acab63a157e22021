// Deep opacity maps against the sum along each ray of the light.
#include <algorithm>

#include "lamp.h"
#include "offscreen.h"
#include "render/render_settings.h"
#include "render/shader_validation.h"

namespace strandcast {
namespace {

TEST(LayerEnds, FollowEachRuleAndEndAtTheDepth) {
  const auto check = [](LayerSizes sizes, std::vector<float> parts) {
    OpacityLayers layers;
    layers.layers = 7;
    layers.sizes = sizes;
    const auto ends = layerEnds(layers, 0.5f);
    float sum = 0, run = 0;
    for (const float part : parts) sum += part;
    for (int k = 0; k < 7; ++k) EXPECT_NEAR(ends[k], 0.5f * (run += parts[k]) / sum, 1e-6) << k;
    for (int k = 7; k < 16; ++k) EXPECT_GT(ends[k], ends[k - 1]);
  };
  check(LayerSizes::kConstant, {1, 1, 1, 1, 1, 1, 1});
  check(LayerSizes::kLinear, {1, 2, 3, 4, 5, 6, 7});
  check(LayerSizes::kPowerOfTwo, {1, 2, 4, 8, 16, 32, 64});
  check(LayerSizes::kFibonacci, {1, 1, 2, 3, 5, 8, 13});
}

class DeepOpacity : public OffscreenTest {
 protected:
  /// Slanted hair, so that the light sees it at many depths.
  static StrandSet guides() {
    StrandSet guides;
    for (int i = 0; i < 100; ++i) {
      const Vec3 root(0.02f * static_cast<float>(i % 10), 0, 0.02f * static_cast<float>(i / 10));
      guides.append(std::vector<Vec3>{root, Vec3(root + Vec3(0.03f, -0.05f, 0)),
                                      Vec3(root + Vec3(0.03f, -0.15f, 0.02f))});
    }
    return guides;
  }
  static RenderSettings settings(const Light& light = {}) {
    RenderSettings settings = smallPicture();
    settings.lights = {light};
    settings.growth.hairs = 1500;
    settings.hair_width = 4e-4f;
    return settings;
  }
};

constexpr int kMapSize = 64;

/// One of each kind: distant, near the hair, and a cone that covers a part of it.
std::vector<Light> lights() {
  return {Light{}, pointLight(Vec3(0.4f, 0.3f, 0.5f), 1),
          spotLight(Vec3(0.1f, 0.3f, 0.3f), Vec3(0, -1, -0.7f), 0.2f, 1)};
}

TEST_F(DeepOpacity, MapsHoldAsMuchHairAsALampSees) {
  for (const Vec3& place : {Vec3(0.4f, 0.3f, 0.5f), Vec3(0.1f, 0.2f, 0.1f), Vec3(-2, 0.1f, 0)}) {
    const RenderSettings wanted = settings(pointLight(place, 1));
    LightProbe probe(guides(), wanted);
    constexpr int kFine = 256;
    // Solid angle of the hair from the lamp: the sum over texels of their optical depth times their solid
    // angle.
    double held = 0;
    for (const LightFragment& f : probe.fragments(kFine)) {
      const double x = (2 * (static_cast<double>(f.x) + 0.5) / kFine - 1) * probe.slope(),
                   y = (2 * (static_cast<double>(f.y) + 0.5) / kFine - 1) * probe.slope();
      const double texel = std::pow(2 * probe.slope() / kFine, 2);
      held += static_cast<double>(f.optical_depth) * texel * std::pow(1 + x * x + y * y, -1.5);
    }
    const HairReference reference(guides(), guides().positions, wanted.segments);
    double seen = 0;
    for (const Hair& hair : growHairs(guides(), wanted.growth)) {
      for (int node = 0; node < wanted.segments; ++node) {
        const Eigen::Vector3d a = reference.at(hair, wanted.growth, node).position,
                              b = reference.at(hair, wanted.growth, node + 1).position;
        const Eigen::Vector3d off = 0.5 * (a + b) - place.cast<double>();
        const double along = (node + 0.5) / (static_cast<double>(hair.extent) * wanted.segments);
        const double width =
            static_cast<double>(wanted.hair_width * hair.width) * std::clamp(4 * (1 - along), 0.0, 1.0);
        seen += width * (b - a).cross(off.normalized()).norm() / off.squaredNorm();
      }
    }
    EXPECT_NEAR(held / seen, 1, 0.03);
  }
}

TEST_F(DeepOpacity, IsExactAtTheEndOfEveryLayer) {
  for (const Light& light : lights()) {
    LightProbe probe(guides(), settings(light));
    std::vector<LightFragment> fragments = probe.fragments(kMapSize);
    ASSERT_GT(fragments.size(), 8000u);
    for (const int count : {3, 7, 11, 15}) {
      for (const LayerSizes sizes : {LayerSizes::kConstant, LayerSizes::kFibonacci}) {
        for (const BeyondLayers beyond :
             {BeyondLayers::kIgnore, BeyondLayers::kLastLayer, BeyondLayers::kReach}) {
          OpacityLayers layers;
          layers.layers = count;
          layers.sizes = sizes;
          layers.beyond = beyond;
          layers.depth = 0.04f;
          layers.map_size = kMapSize;
          // Positions of the front in texels that contain hair.
          std::vector<Vec3> points;
          for (size_t i = 0; i < fragments.size(); i += 499)
            points.emplace_back((fragments[i].x + 0.5f) / kMapSize, (fragments[i].y + 0.5f) / kMapSize,
                                fragments[i].depth);
          const std::vector<LightAnswer> fronts = probe.ask(layers, points);
          const float range = probe.depthRange();
          const float depth = beyond == BeyondLayers::kReach ? range : layers.depth;
          const auto ends = layerEnds(layers, depth);
          std::vector<Vec3> asked;
          // A fragment within rounding of a layer's end may be on either side.
          std::vector<double> least, most;
          for (size_t p = 0; p < points.size(); ++p) {
            ASSERT_LT(fronts[p].behind, range) << "there is hair";
            const double front = points[p].z() - fronts[p].behind / range;
            std::vector<LightFragment> texel;
            for (const LightFragment& f : fragments)
              if (f.x == std::floor(points[p].x() * kMapSize) && f.y == std::floor(points[p].y() * kMapSize))
                texel.push_back(f);
            for (int k = 0; k < count; ++k) {
              // For the last layer, also a point beyond its end.
              const float past = k + 1 == count ? 0.01f : 0;
              asked.emplace_back(points[p].x(), points[p].y(),
                                 static_cast<float>(front + (ends[k] + past) / range));
              double before = 0, by = 0;
              for (const LightFragment& f : texel) {
                const double behind = (f.depth - front) * range;
                const bool always = k + 1 == count && beyond == BeyondLayers::kLastLayer;
                if (always || behind < ends[k] - 3e-6) before += f.optical_depth;
                if (always || behind < ends[k] + 3e-6) by += f.optical_depth;
              }
              least.push_back(before);
              most.push_back(by);
            }
          }
          const std::vector<LightAnswer> answers = probe.ask(layers, asked);
          double deepest = 0;
          for (size_t i = 0; i < answers.size(); ++i) {
            deepest = std::max(deepest, most[i]);
            // Half floats are accumulated, with rounding at each of about a hundred fragments.
            EXPECT_GT(answers[i].optical_depth, 0.98 * least[i] - 0.002) << count << " layers";
            EXPECT_LT(answers[i].optical_depth, 1.02 * most[i] + 0.002) << count << " layers";
          }
          EXPECT_GT(deepest, 0.5);
        }
      }
    }
  }
}

TEST_F(DeepOpacity, FilterAveragesTheTexelsAround) {
  LightProbe probe(guides(), settings());
  OpacityLayers layers;
  layers.map_size = kMapSize;
  std::vector<Vec3> all;
  for (int y = 20; y < 44; ++y)
    for (int x = 20; x < 44; ++x) all.emplace_back((x + 0.5f) / kMapSize, (y + 0.5f) / kMapSize, 0.9f);
  const std::vector<LightAnswer> sharp = probe.ask(layers, all);
  layers.filter = 1;
  const std::vector<LightAnswer> soft = probe.ask(layers, all);
  // Far behind the last layer the depth does not matter, so neighbours can be averaged.
  int compared = 0;
  for (int y = 1; y < 23; ++y) {
    for (int x = 1; x < 23; ++x) {
      double mean = 0;
      for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i) mean += sharp[24 * (y + j) + x + i].optical_depth / 9;
      if (sharp[24 * y + x].behind < 0.12f || sharp[24 * y + x].behind > 10) continue;
      EXPECT_NEAR(soft[24 * y + x].optical_depth, mean, 1e-3 * mean + 1e-4);
      ++compared;
    }
  }
  EXPECT_GT(compared, 100);
}

TEST_F(DeepOpacity, MoreLayersAreNearerToTheTruth) {
  LightProbe probe(guides(), settings());
  std::vector<LightFragment> fragments = probe.fragments(kMapSize);
  std::sort(fragments.begin(), fragments.end(),
            [](const auto& a, const auto& b) { return a.depth < b.depth; });
  std::vector<double> before(kMapSize * kMapSize, 0), exact;
  std::vector<Vec3> points;
  for (const LightFragment& f : fragments) {
    double& sum = before[static_cast<size_t>(f.y * kMapSize + f.x)];
    exact.push_back(std::exp(-sum));
    sum += f.optical_depth;
    points.emplace_back((f.x + 0.5f) / kMapSize, (f.y + 0.5f) / kMapSize, f.depth);
  }
  double last = 1;
  for (const int count : {3, 7, 15}) {
    OpacityLayers layers;
    layers.layers = count;
    layers.map_size = kMapSize;
    layers.beyond = BeyondLayers::kReach;
    const std::vector<LightAnswer> answers = probe.ask(layers, points);
    double error = 0;
    for (size_t i = 0; i < answers.size(); ++i)
      error += std::abs(std::exp(-static_cast<double>(answers[i].optical_depth)) - exact[i]) /
               static_cast<double>(answers.size());
    EXPECT_LT(error, 0.95 * last) << count;
    last = error;
  }
  EXPECT_LT(last, 0.1);
}

}  // namespace
}  // namespace strandcast
