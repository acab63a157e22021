// Several lights at once: pictures with all of them against the sum of pictures with one each.
#include <array>

#include "core/srgb.h"
#include "lamp.h"
#include "offscreen.h"
#include "render/shader_validation.h"

namespace strandcast {
namespace {

/// Bounds of a number that was rounded to 8 bits.
struct Between {
  double low, high;
};

/// Radiance before the tone mapping 1 - exp(-x). Tolerates an sRGB conversion error of a tenth of a step.
Between radianceOf(uint8_t byte) {
  const auto back = [](double step) { return -std::log(1 - linearOf(std::clamp(step / 255, 0.0, 0.999))); };
  return {back(byte - 0.6), back(byte + 0.6)};
}

class Lights : public OffscreenTest {
 protected:
  Lights() : groom_(verticalBundle(10, 10, 0.012f, 0.1f, 0.2f, 8)) {
    settings_ = smallPicture();
    settings_.samples = 1;   // so that a pixel has one radiance
    settings_.cull = false;  // so that the light's maps accumulate the same hairs in the same order
    settings_.hair_width = 3e-4f;
    settings_.hair_color = Vec3(0.4f, 0.3f, 0.2f);
    // Passes that write final colours are left out.
    for (const RenderPass pass : {RenderPass::kBackground, RenderPass::kGround})
      std::erase(settings_.passes, pass);
    body_.mesh.positions = {Vec3(-0.3f, -0.12f, -0.3f), Vec3(-0.3f, -0.12f, 0.3f), Vec3(0.3f, -0.12f, 0.3f),
                            Vec3(0.3f, -0.12f, -0.3f)};
    body_.mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    camera_.eye = Vec3(0.3f, 0.3f, 0.7f);
    camera_.target = Vec3(0, -0.05f, 0);
  }
  static std::vector<Light> three() {
    Light sun;
    sun.intensity = 0.4f;
    Light lamp = pointLight(Vec3(0.4f, 0.3f, 0.3f), 0.06f),
          spot = spotLight(Vec3(-0.3f, 0.5f, 0.2f), Vec3(0.5f, -1, -0.3f), 0.4f, 0.15f);
    lamp.color = Vec3(1, 0.4f, 0.2f);
    spot.color = Vec3(0.2f, 0.5f, 1);
    return {sun, lamp, spot};
  }
  Image draw(const std::vector<Light>& lights) const {
    RenderSettings settings = settings_;
    settings.lights = lights;
    Renderer renderer(settings);
    renderer.setGroom(groom_);
    renderer.setBody(body_);
    renderer.draw(restFrame(groom_), camera_);
    return renderer.read();
  }
  /// A picture must be the sum of each light's contribution and the ambient light, which remains where lights
  /// have almost no intensity. Ambient shadowing of hair and skin is the mean over shadow-casting lights,
  /// weighted by their power.
  void expectSum(const std::vector<Light>& lights) const {
    const Image all = draw(lights);
    std::vector<Image> with, without;
    const auto power = [](const Light& light) {
      return light.casts_shadow ? static_cast<double>(light.intensity * light.color.sum()) : 0.0;
    };
    double casters = 0;
    for (Light light : lights) {
      with.push_back(draw({light}));
      casters += power(light);
      light.intensity = 1e-6f;
      without.push_back(draw({light}));
    }
    int differs = 0, wrong = 0, lit = 0;
    for (size_t i = 0; i < all.rgb.size(); ++i) {
      const Between found = radianceOf(all.rgb[i]);
      Between sum{0, 0};
      for (size_t l = 0; l < lights.size(); ++l) {
        const Between a = radianceOf(with[l].rgb[i]), b = radianceOf(without[l].rgb[i]);
        const double share =
            casters > 0 ? power(lights[l]) / casters : 1.0 / static_cast<double>(lights.size());
        sum.low += a.low - (1 - share) * b.high;
        sum.high += a.high - (1 - share) * b.low;
        differs += with[l].rgb[i] != all.rgb[i];
        lit += with[l].rgb[i] > without[l].rgb[i] + 2;
      }
      wrong += found.high < sum.low || found.low > sum.high;
    }
    EXPECT_GT(lit, 10000) << "there is something to add up";
    EXPECT_GT(differs, 10000);
    EXPECT_EQ(wrong, 0) << "of " << all.rgb.size();
  }

  RenderSettings settings_;
  GroomDescription groom_;
  BodyDescription body_;
  Camera camera_;
};

TEST_F(Lights, APictureIsTheSumOfThoseWithOneLightEach) {
  const std::vector<Light> lights = three();
  expectSum({lights[0], lights[1]});
  expectSum(lights);
  std::vector<Light> most = lights;
  most.push_back(pointLight(Vec3(0, -0.05f, 0.4f), 0.03f));
  ASSERT_EQ(most.size(), kMaxLights);
  settings_.shading = HairShading::kFragment;
  expectSum(most);
}

TEST_F(Lights, ThoseThatCastNoShadowAddWithoutOne) {
  std::vector<Light> lights = three();
  lights[0].casts_shadow = false;  // first in the list, though lights without shadows are sorted last
  expectSum(lights);
  const Image shadowed = draw({three()[0]}), clear = draw({lights[0]});
  int darker = 0;
  for (size_t i = 0; i < clear.rgb.size(); ++i) darker += shadowed.rgb[i] < clear.rgb[i] - 5;
  EXPECT_GT(darker, 2000);
  for (Light& light : lights) light.casts_shadow = false;
  expectSum(lights);
  Image without = draw(lights);
  settings_.shadows = false;
  EXPECT_EQ(draw(three()).rgb, without.rgb) << "all shadows off";
}

TEST_F(Lights, TheirOrderDoesNotMatterAndNoneLeavesTheLightFromAllAround) {
  const std::vector<Light> lights = three();
  const Image one = draw(lights), other = draw({lights[2], lights[0], lights[1]});
  int worst = 0;
  for (size_t i = 0; i < one.rgb.size(); ++i) worst = std::max(worst, std::abs(one.rgb[i] - other.rgb[i]));
  EXPECT_LE(worst, 1) << "rounding";
  Light dark;
  dark.intensity = 0;
  dark.casts_shadow = false;
  EXPECT_EQ(draw({}).rgb, draw({dark}).rgb);
  EXPECT_NE(draw({}).rgb, one.rgb);
  dark.casts_shadow = true;
  EXPECT_EQ(draw({}).rgb, draw({dark}).rgb) << "nothing to cast a shadow of";
}

TEST_F(Lights, MapsOfSeveralAreThoseOfEach) {
  const std::vector<Light> lights = three();
  RenderSettings settings = settings_;
  OpacityLayers layers;
  layers.map_size = 64;
  std::vector<Vec3> points;
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 24; ++x)
      for (const float depth : {0.45f, 0.5f, 0.55f, 0.7f})
        points.emplace_back((static_cast<float>(x) + 20.3f) / 64, (static_cast<float>(y) + 20.6f) / 64,
                            depth);
  settings.lights = lights;
  LightProbe all(groom_.guides, settings);
  for (size_t i = 0; i < lights.size(); ++i) {
    settings.lights = {lights[i]};
    LightProbe alone(groom_.guides, settings);
    for (const int count : {3, 15}) {
      layers.layers = count;
      const std::vector<LightAnswer> a = all.ask(layers, points, i), b = alone.ask(layers, points);
      int shaded = 0;
      for (size_t p = 0; p < points.size(); ++p) {
        ASSERT_EQ(a[p].behind, b[p].behind) << i;
        ASSERT_EQ(a[p].optical_depth, b[p].optical_depth) << i;
        shaded += a[p].optical_depth > 0.1f;
      }
      EXPECT_GT(shaded, 100) << i;
    }
    EXPECT_EQ(all.fragments(64, i).size(), alone.fragments(64).size());
  }
}

TEST_F(Lights, MoreThanThereMayBeAreLeftOut) {
  std::vector<Light> lights(9, three()[1]);
  for (size_t i = 0; i < lights.size(); ++i) lights[i].position.x() += 0.1f * static_cast<float>(i);
  const Image nine = draw(lights);
  lights.resize(kMaxLights);
  EXPECT_EQ(nine.rgb, draw(lights).rgb);
}

}  // namespace
}  // namespace strandcast
