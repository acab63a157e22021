#include <limits>
#include <numbers>
#include <utility>

#include "offscreen.h"
#include "render/hair_growth.h"

namespace strandcast {
namespace {

BodyDescription sphere(float radius, const Vec3& center) {
  constexpr uint32_t kAround = 32, kAlong = 16;
  BodyDescription body;
  for (uint32_t j = 0; j <= kAlong; ++j) {
    for (uint32_t i = 0; i <= kAround; ++i) {
      const float polar = std::numbers::pi_v<float> * j / kAlong,
                  turn = 2 * std::numbers::pi_v<float> * i / kAround;
      const Vec3 d(std::sin(polar) * std::sin(turn), std::cos(polar), std::sin(polar) * std::cos(turn));
      body.mesh.positions.push_back(Vec3(center + radius * d));
    }
  }
  for (uint32_t j = 0; j < kAlong; ++j) {
    for (uint32_t i = 0; i < kAround; ++i) {
      const uint32_t a = j * (kAround + 1) + i, b = a + kAround + 1;
      body.mesh.triangles.push_back({a, b, a + 1});
      body.mesh.triangles.push_back({a + 1, b, b + 1});
    }
  }
  return body;
}

using Picture = OffscreenTest;

/// Number of pixels that hair covers, by the change of the picture from the background towards black hair.
double coveredPixels(const RenderSettings& settings, const GroomDescription& groom, const Camera& camera) {
  Renderer renderer(settings);
  renderer.setGroom(groom);
  GuideFrame frame = restFrame(groom);
  renderer.draw(frame, camera);
  const Image with = renderer.read();
  for (Vec3& p : frame.positions)
    p.x() = std::numeric_limits<float>::quiet_NaN();  // the same scene without hair
  renderer.draw(frame, camera);
  const Image without = renderer.read();
  double covered = 0;
  for (int y = 0; y < settings.height; ++y)
    for (int x = 0; x < settings.width; ++x)
      covered += 1 - linearValue(with, x, y, 2) / linearValue(without, x, y, 2);
  return covered;
}

/// A bundle of black, unlit hair before a bright background.
struct Silhouette {
  explicit Silhouette(RenderSettings& settings) {
    settings.background = Vec3(0.9f, 0.9f, 0.9f);
    settings.hair_color = Vec3::Zero();
    settings.lights[0].intensity = 0;
    camera.eye = Vec3(0.2f, 0.1f, 0.6f);
    camera.target = Vec3::Zero();
  }
  const GroomDescription groom = verticalBundle(10, 10, 0.012f, 0.1f, 0.2f, 8);
  Camera camera;
};

TEST_F(Picture, StraightBundleCoversTheAreaOfItsHairs) {
  RenderSettings settings = smallPicture();
  settings.width = settings.height = 256;
  settings.shadows = false;
  settings.hair_color = Vec3::Zero();
  settings.lights[0].direction = Vec3(0, -1, 0);  // along the hair: no highlight, no diffuse light
  settings.background = Vec3(0.8f, 0.8f, 0.8f);
  settings.growth.hairs = 60;  // few enough that they hardly overlap
  settings.growth.clump_radius = 0.0005f;
  const GroomDescription groom = verticalBundle(200, 1, 0.0012f, 0.1f, 0.2f, 8);
  Camera camera;
  camera.eye = Vec3(0, 0, 2);
  camera.target = Vec3::Zero();
  camera.vertical_fov = 0.2f;
  const double pixel = 2 * 2 * std::tan(0.1) / 256;
  struct Way {
    HairGeometry geometry;
    HairCoverage coverage;
    int samples;
    double pixels_wide;
  };
  for (const Way& way : {Way{HairGeometry::kLines, HairCoverage::kStochastic, 4, 0.1},
                         Way{HairGeometry::kLines, HairCoverage::kStochastic, 4, 0.3},
                         Way{HairGeometry::kLines, HairCoverage::kStochastic, 2, 0.3},
                         Way{HairGeometry::kLines, HairCoverage::kAlphaToCoverage, 4, 0.3},
                         Way{HairGeometry::kStrips, HairCoverage::kStochastic, 4, 0.1},
                         Way{HairGeometry::kStrips, HairCoverage::kStochastic, 4, 1.7},
                         Way{HairGeometry::kStrips, HairCoverage::kAlphaToCoverage, 4, 0.3}}) {
    settings.geometry = way.geometry;
    settings.coverage = way.coverage;
    settings.samples = way.samples;
    settings.hair_width = static_cast<float>(way.pixels_wide * pixel);
    double wanted = 0;  // the taper of the last quarter loses an eighth of a hair
    for (const Hair& hair : growHairs(groom.guides, settings.growth))
      wanted += way.pixels_wide * hair.width * 0.875 * hair.extent * 0.2 / pixel;
    const double covered = coveredPixels(settings, groom, camera);
    EXPECT_NEAR(covered / wanted, 1, 0.12)
        << way.pixels_wide << " pixels wide, " << way.samples << " samples, geometry "
        << static_cast<int>(way.geometry) << ", coverage " << static_cast<int>(way.coverage);
  }
}

TEST_F(Picture, ThinHairCoversAsMuchOfABrightBackgroundAsEightTimesAsManyPixelsShow) {
  RenderSettings settings = smallPicture();
  settings.growth.hairs = 3000;
  settings.growth.curl_radius = 0.01f;  // so that hairs cross
  const Silhouette scene(settings);
  const auto picture = [&](int size, bool hair) {
    settings.width = settings.height = size;
    Renderer renderer(settings);
    if (hair) renderer.setGroom(scene.groom);
    renderer.draw(hair ? restFrame(scene.groom) : GuideFrame{}, scene.camera);
    return renderer.read();
  };
  for (const float width : {8e-5f, 2.5e-4f}) {  // a fiftieth and a sixteenth of a pixel
    settings.hair_width = width;
    double shown = 0, exact = 0, bare = 0, specks = 0;
    int pixels = 0;
    for (const uint64_t seed : {1, 2, 3}) {
      settings.growth.seed = seed;
      const Image none = picture(96, false), small = picture(96, true), large = picture(768, true);
      for (int y = 30; y < 66; ++y)
        for (int x = 36; x < 60; ++x, ++pixels) {
          double pixel = 0;
          for (int j = 0; j < 8; ++j)
            for (int i = 0; i < 8; ++i) pixel += linearValue(large, 8 * x + i, 8 * y + j, 1) / 64;
          bare += linearValue(none, x, y, 1);
          shown += linearValue(small, x, y, 1);
          exact += pixel;
          specks += std::abs(linearValue(small, x, y, 1) - pixel);
        }
    }
    EXPECT_NEAR(1 - shown / bare, 1 - exact / bare, 0.03) << width;
    EXPECT_GT(specks / pixels, 0.005) << "single pixels differ: they have four samples of what has gaps";
  }
}

TEST_F(Picture, FewHairsInPlaceOfManyAreAsDense) {
  RenderSettings settings = smallPicture();
  settings.width = settings.height = 96;
  settings.growth.hairs = 60000;
  settings.hair_width = 6e-6f;  // three layers of hair; one hair in 160 is drawn
  const Silhouette scene(settings);
  Renderer renderer(settings);
  renderer.setGroom(scene.groom);
  GuideFrame frame = restFrame(scene.groom);
  double left[2] = {};
  for (const bool hair : {true, false}) {
    if (!hair)
      frame.positions.assign(frame.positions.size(), Vec3::Constant(std::numeric_limits<float>::quiet_NaN()));
    renderer.draw(frame, scene.camera);
    if (hair) {
      EXPECT_LT(renderer.statistics().hairs_drawn, 1000u);
    }
    const Image image = renderer.read();
    for (int y = 36; y < 60; ++y)
      for (int x = 42; x < 54; ++x) left[hair] += linearValue(image, x, y, 1);
  }
  EXPECT_LT(left[1], 0.12 * left[0]) << "of the light behind";
}

TEST_F(Picture, HairOfHardlyAnyWidthIsNotSeen) {
  RenderSettings settings = smallPicture();
  settings.detail = {1, 0, 0, 0};
  const GroomDescription groom = verticalBundle(8, 8, 0.01f, 0.1f, 0.2f, 8);
  for (const HairGeometry geometry : {HairGeometry::kLines, HairGeometry::kStrips}) {
    settings.geometry = geometry;
    Image images[2];
    for (const bool hair : {false, true}) {
      settings.growth.hairs = hair ? 1000 : 0;
      settings.growth.thickness =
          std::make_shared<const ScalpMap>(ScalpMap{1, 1, {1e-41f}});  // which devices flush to 0
      Renderer renderer(settings);
      renderer.setGroom(groom);
      renderer.draw(restFrame(groom), Camera{});
      images[hair] = renderer.read();
    }
    EXPECT_EQ(images[0].rgb, images[1].rgb) << static_cast<int>(geometry);
  }
}

TEST_F(Picture, LinesSeenFromNearAreHardlyWiderThanStrips) {
  RenderSettings settings = smallPicture();
  settings.width = settings.height = 256;
  settings.shadows = false;
  settings.growth.hairs = 12;
  settings.growth.curl_radius = 0.004f;
  settings.hair_width = 6e-4f;
  const GroomDescription groom = verticalBundle(6, 1, 0.015f, 0.1f, 0.2f, 2);  // long edges, so wide boxes
  Camera camera;
  camera.eye = Vec3(0, 0, 0.15f);  // within the boxes
  camera.target = Vec3::Zero();
  const auto touched = [&](HairGeometry geometry, bool hair) {
    settings.geometry = geometry;
    Renderer renderer(settings);
    if (hair) renderer.setGroom(groom);
    renderer.draw(hair ? restFrame(groom) : GuideFrame{}, camera);
    return renderer.read();
  };
  const Image bare = touched(HairGeometry::kStrips, false);
  int pixels[2] = {};
  for (const HairGeometry geometry : {HairGeometry::kLines, HairGeometry::kStrips}) {
    const Image image = touched(geometry, true);
    for (size_t i = 0; i < image.rgb.size(); i += 3)
      pixels[geometry == HairGeometry::kStrips] += std::abs(image.rgb[i] - bare.rgb[i]) > 3;
  }
  EXPECT_GT(pixels[1], 1000);
  EXPECT_LT(pixels[0], 1.6 * pixels[1]);
  EXPECT_GT(pixels[0], 0.6 * pixels[1]);
}

TEST_F(Picture, HairsThatReachNoSampleAreLeftOutAndNotMissed) {
  RenderSettings settings = smallPicture();
  settings.growth.hairs = 4000;
  settings.shadows = false;
  const GroomDescription groom = verticalBundle(8, 8, 0.02f, 0.1f, 0.2f, 8);
  Image images[2];
  size_t drawn[2];
  for (const bool full : {true, false}) {
    settings.detail = LevelOfDetail{full ? 1.0f : 0.0f, 0, 0};
    Renderer renderer(settings);
    renderer.setGroom(groom);
    renderer.draw(restFrame(groom), Camera{});
    images[full] = renderer.read();
    drawn[full] = renderer.statistics().hairs_drawn;
  }
  EXPECT_EQ(images[0].rgb, images[1].rgb);
  EXPECT_EQ(drawn[1], 4000u);
  EXPECT_LT(drawn[0], 2000u);
}

TEST_F(Picture, FewerAndWiderHairsCoverTheSameArea) {
  RenderSettings settings = smallPicture();
  settings.growth.hairs = 2000;
  settings.growth.clump_radius = 0.001f;
  settings.shadows = false;
  settings.hair_color = Vec3::Zero();
  settings.lights[0].direction = Vec3(0, -1, 0);
  settings.background = Vec3(0.8f, 0.8f, 0.8f);
  settings.hair_width = 2e-5f;  // a quarter of the picture is covered
  const GroomDescription groom = verticalBundle(100, 1, 0.0025f, 0.1f, 0.2f, 8);
  double covered[2];
  for (const bool full : {true, false}) {
    settings.detail = LevelOfDetail{full ? 1.0f : 0.1f, 0, 0};
    covered[full] = coveredPixels(settings, groom, Camera{});
  }
  EXPECT_GT(covered[1], 200);
  EXPECT_NEAR(covered[0] / covered[1], 1, 0.06);
}

TEST_F(Picture, SupersamplingWeighsTheSamplesOfALargerPicture) {
  RenderSettings settings = smallPicture();
  settings.width = settings.height = 48;
  settings.hair_width = 4e-4f;
  const GroomDescription groom = verticalBundle(8, 8, 0.02f, 0.1f, 0.2f, 8);
  const auto picture = [&] {
    Renderer renderer(settings);
    renderer.setGroom(groom);
    renderer.draw(restFrame(groom), Camera{});
    return renderer.read();
  };
  RenderSettings large_settings = settings;
  for (const int factor : {2, 3}) {
    settings = large_settings;
    settings.width *= factor;
    settings.height *= factor;
    const Image large = picture();
    for (const PixelFilter filter :
         {PixelFilter::kBox, PixelFilter::kTent, PixelFilter::kGaussian, PixelFilter::kMitchell}) {
      settings = large_settings;
      settings.supersampling = factor;
      settings.filter = filter;
      const Image small = picture();
      double worst = 0;
      for (int y = 4; y < 44; ++y) {
        for (int x = 4; x < 44; ++x) {
          double sum = 0, weights = 0;
          for (int j = (y - 3) * factor; j < (y + 4) * factor; ++j) {
            for (int i = (x - 3) * factor; i < (x + 4) * factor; ++i) {
              const double w = static_cast<double>(
                  filterWeight(filter, (static_cast<float>(i) + 0.5f) / static_cast<float>(factor) -
                                           static_cast<float>(x) - 0.5f) *
                  filterWeight(filter, (static_cast<float>(j) + 0.5f) / static_cast<float>(factor) -
                                           static_cast<float>(y) - 0.5f));
              sum += w * linearValue(large, i, j, 1);
              weights += w;
            }
          }
          worst =
              std::max(worst, std::abs(linearValue(small, x, y, 1) - std::clamp(sum / weights, 0.0, 1.0)));
        }
      }
      EXPECT_LT(worst, 0.008) << factor << " " << static_cast<int>(filter);  // one step of sRGB
    }
  }
}

TEST_F(Picture, BodyShadowDarkensTheGroundBelowIt) {
  RenderSettings settings = smallPicture();
  settings.lights[0].direction = Vec3(0, -1, -0.02f);
  Camera camera;
  camera.eye = Vec3(0, 1.2f, 1.6f);
  camera.target = Vec3(0, -0.2f, 0);
  // A small triangle of body far below keeps the ground away from the sphere.
  BodyDescription body = sphere(0.2f, Vec3(0, 0.2f, 0));
  const auto first = static_cast<uint32_t>(body.mesh.positions.size());
  for (const Vec3& p : {Vec3(0, -0.4f, -0.01f), Vec3(0.01f, -0.4f, 0), Vec3(0, -0.4f, 0.01f)})
    body.mesh.positions.push_back(p);
  body.mesh.triangles.push_back({first, first + 1, first + 2});
  const auto groundBrightness = [&](bool shadows, const Vec3& place) {
    settings.shadows = shadows;
    Renderer renderer(settings);
    renderer.setBody(body);
    renderer.draw(GuideFrame{}, camera);
    const Image image = renderer.read();
    const Eigen::Vector4f clip = perspective(camera.vertical_fov, 1, 0.02f, 50) *
                                 viewMatrix(camera.eye, camera.target) *
                                 Eigen::Vector4f(place.x(), place.y(), place.z(), 1);
    const int x = static_cast<int>((0.5f + 0.5f * clip.x() / clip.w()) * 128),
              y = static_cast<int>((0.5f - 0.5f * clip.y() / clip.w()) * 128);
    EXPECT_TRUE(x >= 0 && y >= 0 && x < 128 && y < 128);
    return linearValue(image, x, y, 1);
  };
  const Vec3 under(0, -0.4f, 0.12f), beside(0.35f, -0.4f, 0.12f);
  EXPECT_LT(groundBrightness(true, under), 0.6 * groundBrightness(false, under));
  EXPECT_NEAR(groundBrightness(true, beside), groundBrightness(false, beside), 0.01);
}

TEST_F(Picture, HairShadesTheGroundAndItself) {
  RenderSettings settings = smallPicture();
  settings.growth.hairs = 4000;
  settings.hair_width = 400e-6f;
  settings.lights[0].direction = Vec3(0, -1, -1);
  const GroomDescription groom = verticalBundle(12, 12, 0.008f, 0.1f, 0.15f, 8);
  Camera camera;
  camera.eye = Vec3(0.4f, 0.25f, -0.8f);  // sees the unlit side
  camera.target = Vec3(0, 0, 0);
  double sum[2];
  for (const bool shadows : {false, true}) {
    settings.shadows = shadows;
    Renderer renderer(settings);
    renderer.setGroom(groom);
    renderer.draw(restFrame(groom), camera);
    const Image image = renderer.read();
    sum[shadows] = 0;
    for (int y = 56; y < 72; ++y)
      for (int x = 56; x < 72; ++x) sum[shadows] += linearValue(image, x, y, 1);
  }
  EXPECT_LT(sum[1], 0.7 * sum[0]);
}

TEST_F(Picture, SameInputGivesTheSamePicture) {
  const GroomDescription groom = verticalBundle(8, 8, 0.01f, 0.1f, 0.2f, 8);
  const BodyDescription body = sphere(0.05f, Vec3(0, 0, 0));
  Image images[2];
  for (Image& image : images) {
    Renderer renderer(smallPicture());
    renderer.setGroom(groom);
    renderer.setBody(body);
    renderer.draw(restFrame(groom), Camera{});
    image = renderer.read();
    EXPECT_EQ(renderer.statistics().hairs_grown, 1000u);
    EXPECT_GT(renderer.statistics().hairs_drawn, 50u);
  }
  EXPECT_EQ(images[0].rgb, images[1].rgb);
}

TEST_F(Picture, PassesThatDrawMayComeInAnyOrder) {
  const GroomDescription groom = verticalBundle(8, 8, 0.01f, 0.1f, 0.2f, 8);
  const BodyDescription body = sphere(0.05f, Vec3(0, 0, 0));
  RenderSettings settings = smallPicture();
  const auto picture = [&] {
    Renderer renderer(settings);
    renderer.setGroom(groom);
    renderer.setBody(body);
    renderer.draw(restFrame(groom), Camera{});
    EXPECT_EQ(renderer.statistics().passes.size(), settings.passes.size());
    return renderer.read();
  };
  const Image usual = picture();
  std::swap(settings.passes[4], settings.passes[7]);  // hair first, then body and ground, the background last
  EXPECT_EQ(settings.passes[4], RenderPass::kHair);
  EXPECT_EQ(picture().rgb, usual.rgb);
  std::erase(settings.passes, RenderPass::kHair);
  EXPECT_NE(picture().rgb, usual.rgb);
  settings.passes = {RenderPass::kBackground, RenderPass::kResolve, RenderPass::kBackground};
  Renderer renderer(settings);
  renderer.draw(GuideFrame{}, Camera{});
  EXPECT_EQ(renderer.statistics().passes.size(), 2u) << "a pass named twice is done once";
}

TEST_F(Picture, SettingsThatChangeLaterGiveThePictureThatTheyGiveFromTheStart) {
  const GroomDescription groom = verticalBundle(8, 8, 0.01f, 0.1f, 0.2f, 8);
  const BodyDescription body = sphere(0.05f, Vec3(0, 0, 0));
  const auto scene = [&](Renderer& renderer) {
    renderer.setGroom(groom);
    renderer.setBody(body);
  };
  RenderSettings without_memory = smallPicture();
  without_memory.detail.hysteresis = 0;  // with hysteresis a picture may depend slightly on previous ones
  std::vector<RenderSettings> all(10, without_memory);
  all[1].segments = 5;
  all[2].geometry = HairGeometry::kStrips;
  all[3].growth.hairs = 300;
  all[4].opacity.layers = 15;
  all[5].supersampling = 2;
  all[5].width = 90;
  all[6].growth_path = GrowthPath::kTessellator;
  all[7].hair_color = Vec3(0.5f, 0.5f, 0.1f);
  all[8].lights.resize(3);
  all[8].lights[1].color = Vec3(1, 0.5f, 0.2f);
  all[8].lights[2].direction = Vec3(1, -1, 0);
  all[9] = all[8];
  all[9].lights[1].casts_shadow = false;
  Renderer changing(all[0]);
  scene(changing);
  for (size_t i : {1u, 2u, 3u, 4u, 5u, 6u, 8u, 9u, 7u, 8u, 0u}) {
    Renderer fresh(all[i]);
    scene(fresh);
    fresh.draw(restFrame(groom), Camera{});
    changing.setSettings(all[i]);
    changing.draw(restFrame(groom), Camera{});
    EXPECT_EQ(changing.read().rgb, fresh.read().rgb) << i;
  }
}

TEST_F(Picture, HoldsWhatItFramesOfAnySize) {
  RenderSettings settings = smallPicture();
  settings.growth.hairs = 200;
  for (const float size : {5e-4f, 0.1f, 60.0f}) {
    const BodyDescription body = sphere(size, Vec3(0, size, 0));
    GroomDescription groom;
    for (int i = 0; i < 9; ++i)
      groom.guides.append(std::vector<Vec3>{Vec3(size * Vec3(0.1f * (i % 3), 2, 0.1f * (i / 3))),
                                            Vec3(size * Vec3(0.1f * (i % 3), 3, 0.1f * (i / 3)))});
    Box box = Box(Eigen::Vector3f(-size, 0, -size), Eigen::Vector3f(size, 3 * size, size));
    settings.hair_width = std::min(0.02f * size, 0.1f);
    settings.growth.clump_radius = settings.growth.tip_deviation = settings.growth.whole_deviation =
        0.01f * size;
    Renderer renderer(settings);
    renderer.setBody(body);
    renderer.setGroom(groom);
    renderer.draw(restFrame(groom), orbit(box, 0.3f, 0.1f, 1));
    const Image image = renderer.read();
    int skin = 0, hair = 0;
    for (int y = 0; y < 128; ++y)
      for (int x = 0; x < 128; ++x)  // both are redder than anything else
        (y < 52 ? hair : skin) += linearValue(image, x, y, 0) > linearValue(image, x, y, 2) + 0.02;
    EXPECT_GT(skin, 1000) << size;
    EXPECT_GT(hair, 40) << size;
  }
}

TEST_F(Picture, IsTheSameOfWhatIsSmall) {
  const auto picture = [&](float size) {  // m, of the whole content
    RenderSettings settings = smallPicture();
    settings.hair_width = 0.01f * size;
    settings.growth.clump_radius = 0.02f * size;
    settings.growth.tip_deviation = settings.growth.whole_deviation = 0.03f * size;
    settings.opacity.beyond = BeyondLayers::kReach;
    settings.lights[0].direction = Vec3(0.5f, -1, -1);
    const GroomDescription groom = verticalBundle(8, 8, 0.03f * size, 0.5f * size, 0.6f * size, 8);
    Renderer renderer(settings);
    renderer.setGroom(groom);
    renderer.setBody(sphere(0.15f * size, Vec3(0, 0.4f * size, 0)));
    Camera camera;
    camera.eye = Vec3(0.3f * size, 0.8f * size, 1.5f * size);
    camera.target = Vec3(0, 0.2f * size, 0);
    renderer.draw(restFrame(groom), camera);
    return renderer.read();
  };
  const Image usual = picture(0.125f), small = picture(0.125f / 32);
  double difference = 0;
  for (size_t i = 0; i < usual.rgb.size(); ++i)
    difference += std::abs(usual.rgb[i] - small.rgb[i]) / static_cast<double>(usual.rgb.size());
  EXPECT_LT(difference, 0.5) << "of 255";
}

TEST_F(Picture, HairIsDrawnFarFromTheOrigin) {
  RenderSettings settings = smallPicture();
  settings.hair_width = 1e-3f;
  const auto hairPixels = [&](const Vec3& place, const Vec3& head) {
    GroomDescription groom = verticalBundle(8, 8, 0.01f, 0.1f, 0.2f, 8);
    for (Vec3& p : groom.guides.positions) p += place;
    Renderer renderer(settings);
    renderer.setGroom(groom);
    GuideFrame frame = restFrame(groom);
    frame.head.position = head;
    for (Vec3& p : frame.positions) p += head;
    frame.positions[3] = Vec3(-1e6f, 0, 0);  // a damaged vertex must not enlarge bounds
    Camera camera;
    camera.target = place + head;
    camera.eye = Vec3(camera.target + Vec3(0, 0.1f, 0.8f));
    renderer.draw(frame, camera);
    const Image image = renderer.read();
    int hair = 0;
    for (int y = 0; y < 128; ++y)
      for (int x = 0; x < 128; ++x)  // redder than the rest
        hair += linearValue(image, x, y, 0) > linearValue(image, x, y, 2) + 0.02;
    return hair;
  };
  const int at_origin = hairPixels(Vec3::Zero(), Vec3::Zero());
  EXPECT_GT(at_origin, 200);
  EXPECT_NEAR(hairPixels(Vec3(2000, 0, -3000), Vec3::Zero()), at_origin, 0.1 * at_origin);
  EXPECT_NEAR(hairPixels(Vec3::Zero(), Vec3(0, 2000, 0)), at_origin, 0.1 * at_origin);
}

TEST_F(Picture, SkinIsNotDarkenedByHairBehindTheSolidThatItIsOf) {
  RenderSettings settings = smallPicture();
  settings.growth.hairs = 4000;
  settings.hair_width = 1e-3f;
  settings.lights[0].direction = Vec3(0, 0, 1);  // from behind
  GroomDescription groom = verticalBundle(10, 4, 0.01f, 0.06f, 0.12f, 8);
  for (Vec3& p : groom.guides.positions) p.z() -= 0.16f;
  Renderer renderer(settings);
  renderer.setGroom(groom);
  renderer.setBody(sphere(0.12f, Vec3::Zero()));
  Camera camera;
  camera.eye = Vec3(0, 0, 0.6f);
  camera.target = Vec3::Zero();
  GuideFrame frame = restFrame(groom);
  renderer.draw(frame, camera);
  const Image with = renderer.read();
  for (Vec3& p : frame.positions) p.y() = std::numeric_limits<float>::quiet_NaN();
  renderer.draw(frame, camera);
  const Image without = renderer.read();
  for (int y = 44; y < 84; ++y)
    for (int x = 44; x < 84; ++x)
      ASSERT_NEAR(linearValue(with, x, y, 1), linearValue(without, x, y, 1), 0.005) << x << " " << y;
}

TEST_F(Picture, GroundIsBelowHairThatIsLongerThanItsBody) {
  RenderSettings settings = smallPicture();
  settings.growth.hairs = 2000;
  settings.hair_width = 1e-3f;
  settings.shadows = false;
  settings.background = Vec3(0.8f, 0.8f, 0.8f);
  settings.hair_color = Vec3::Zero();
  settings.lights[0].direction = Vec3(0, -1, 0);  // along the hair
  const GroomDescription groom = verticalBundle(12, 12, 0.008f, 0, 0.5f, 8);
  Renderer renderer(settings);
  renderer.setGroom(groom);
  renderer.setBody(sphere(0.06f, Vec3(0, 0.05f, 0)));
  Camera camera;
  camera.eye = Vec3(0, 0.2f, 1.2f);
  camera.target = Vec3(0, -0.4f, 0);  // at the hair, far below the body
  camera.vertical_fov = 0.1f;
  renderer.draw(restFrame(groom), camera);
  EXPECT_LT(linearValue(renderer.read(), 64, 64, 1), 0.05);
}

std::pair<Image, Image> withoutAndWithShadows(RenderSettings settings, const GroomDescription& groom,
                                              const Camera& camera) {
  const auto picture = [&](bool shadows) {
    settings.shadows = shadows;
    Renderer renderer(settings);
    renderer.setGroom(groom);
    renderer.draw(restFrame(groom), camera);
    return renderer.read();
  };
  Image lit = picture(false);
  return {std::move(lit), picture(true)};
}

TEST_F(Picture, HairFarFromItsGuidesCastsItsShadowToo) {
  RenderSettings settings = smallPicture();
  settings.growth.hairs = 2000;
  settings.growth.curl_radius = 0.4f;
  settings.growth.curl_pitch = 0.15f;
  settings.segments = 64;
  settings.hair_width = 2e-3f;
  settings.background = Vec3(0.8f, 0.8f, 0.8f);
  settings.lights[0].direction = Vec3(1, -1, 0);
  std::erase(settings.passes, RenderPass::kHair);  // only the ground
  const GroomDescription groom = verticalBundle(2, 2, 0.01f, 0.15f, 0.3f, 8);
  Camera camera;
  camera.eye = Vec3(0.2f, 2, 0);  // z is up in the picture
  camera.target = Vec3(0.2f, -0.2f, 0);
  camera.vertical_fov = 0.8f;
  const auto [lit, shaded] = withoutAndWithShadows(settings, groom, camera);
  const double pixel = 2 * 2.2 * std::tan(0.4) / 128;
  int dark = 0;
  for (int y = 0; y < 128; ++y) {
    if (std::abs(y - 63.5) * pixel < 0.25) continue;  // m: the edge of a map that covers only the guides
    for (int x = 0; x < 128; ++x) dark += linearValue(shaded, x, y, 1) < 0.9 * linearValue(lit, x, y, 1);
  }
  EXPECT_GT(dark, 200);
}

TEST_F(Picture, ShadowOfABroadHairIsAsBroad) {
  RenderSettings settings = smallPicture();
  settings.growth.hairs = 1;
  settings.growth.tip_deviation = settings.growth.whole_deviation = settings.growth.clump_radius = 0;
  settings.hair_width = 0.03f;  // about 25 texels of the map
  settings.background = Vec3(0.8f, 0.8f, 0.8f);
  std::erase(settings.passes, RenderPass::kHair);
  Camera camera;
  camera.eye = Vec3(0.3f, 2, 0);
  camera.target = Vec3(0.3f, -0.2f, 0);
  camera.vertical_fov = 0.3f;
  const GroomDescription groom = verticalBundle(1, 1, 0.01f, 0.15f, 0.3f, 8);
  const Hair hair = growHairs(groom.guides, settings.growth).front();
  Light lamp;
  lamp.kind = LightKind::kPoint;
  lamp.position = Vec3(-2, 2, 0);
  lamp.intensity = 8;
  Light sun;
  sun.direction = Vec3(1, -1, 0);
  for (const Light& light : {sun, lamp}) {
    settings.lights = {light};
    const auto [lit, shaded] = withoutAndWithShadows(settings, groom, camera);
    const double pixel = 2 * 2.2 * std::tan(0.15) / 128;
    int dark = 0;  // in the column below the middle of the hair
    for (int y = 0; y < 128; ++y) {
      bool is_dark = false;
      for (int x = 60; x < 68; ++x)
        is_dark |= linearValue(shaded, x, y, 1) < 0.95 * linearValue(lit, x, y, 1);
      dark += is_dark;
    }
    const double width = 0.03 * static_cast<double>(hair.width);
    EXPECT_GT(dark * pixel, 0.6 * width) << static_cast<int>(light.kind);
    EXPECT_LT(dark * pixel, 1.6 * width) << static_cast<int>(light.kind);
  }
}

TEST_F(Picture, BodyFollowsTheHeadByItsWeights) {
  RenderSettings settings = smallPicture();
  BodyDescription body = sphere(0.1f, Vec3::Zero());
  Camera camera;
  camera.eye = Vec3(0, 0, 2);
  camera.target = Vec3::Zero();
  const auto middle = [&](float weight) {
    body.head_weights.assign(body.mesh.positions.size(), weight);
    Renderer renderer(settings);
    renderer.setBody(body);
    GuideFrame frame;
    frame.head.position = Vec3(0, 0.4f, 0);
    renderer.draw(frame, camera);
    const Image image = renderer.read();
    return linearValue(image, 64, 64, 0) -
           linearValue(image, 64, 64, 2);  // skin is redder than anything else
  };
  EXPECT_GT(middle(0), 0.1);
  EXPECT_LT(middle(1), 0.0);
}

}  // namespace
}  // namespace strandcast
