// Frames of the renderer, path traced: options/traced_picture.h and Renderer::geometry().
#include "options/traced_picture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <memory>

#include "io/exr.h"
#include "options/console.h"
#include "render/renderer.h"
#include "tests/expect_error.h"
#include "tests/render/offscreen.h"

namespace strandcast {
namespace {

class TracedPictures : public OffscreenTest {
 protected:
  void SetUp() override {
    OffscreenTest::SetUp();
    if (IsSkipped()) return;
    groom_ = verticalBundle(4, 4, 0.01f, 0.1f, 0.15f, 12);
    body_.mesh.positions = {Vec3(-0.1f, 0.1f, -0.1f), Vec3(0.1f, 0.1f, -0.1f), Vec3(0, 0.1f, 0.1f)};
    body_.mesh.triangles = {{0, 2, 1}};
    settings_ = smallPicture();
    settings_.width = settings_.height = 32;
    settings_.growth.hairs = 300;
    settings_.segments = 8;
    settings_.hair_width = 1e-3f;
    settings_.lights = std::vector<Light>(1);
    renderer_ = std::make_unique<Renderer>(settings_);
    renderer_->setGroom(groom_);
    renderer_->setBody(body_);
    camera_ =
        orbit(Box(Eigen::Vector3f(-0.1f, -0.05f, -0.1f), Eigen::Vector3f(0.1f, 0.1f, 0.1f)), 0.3f, 0.2f, 1);
  }

  PathScene scene(const TraceOptions& options) {
    return pathScene(renderer_->geometry(restFrame(groom_)), renderer_->settings(), camera_, options,
                     skyOf(options));
  }
  TracedPicture trace(const TraceOptions& options) {
    return tracePicture(scene(options), options, exposureGains(settings_), file_, "a test");
  }

  GroomDescription groom_;
  BodyDescription body_;
  RenderSettings settings_;
  Camera camera_;
  std::unique_ptr<Renderer> renderer_;
  const std::filesystem::path file_ =
      std::filesystem::path(STRANDCAST_BINARY_DIR) / "traced_picture_test.exr";
};

TEST_F(TracedPictures, GeometryHasAllHairAndThePosedBodyAndLeavesPicturesAlone) {
  const GuideFrame rest = restFrame(groom_);
  renderer_->draw(rest, camera_);
  const Image before = renderer_->read();
  const size_t grown = renderer_->statistics().hairs_grown;
  const PictureGeometry geometry = renderer_->geometry(rest);
  EXPECT_EQ(geometry.hairs(), grown);
  ASSERT_EQ(geometry.offsets.back(), geometry.positions.size());
  EXPECT_EQ(geometry.tangents.size(), geometry.positions.size());
  EXPECT_EQ(geometry.widths.size(), geometry.positions.size());
  EXPECT_EQ(geometry.colors.size(), grown);
  for (size_t v = 0; v < geometry.positions.size(); ++v) {
    EXPECT_NEAR(geometry.tangents[v].norm(), 1, 1e-4);
    EXPECT_LT(geometry.positions[v].cwiseAbs().maxCoeff(), 0.12f);
    EXPECT_GT(geometry.widths[v], 0);
  }
  renderer_->draw(rest, camera_);
  EXPECT_EQ(renderer_->read().rgb, before.rgb);

  GuideFrame moved = rest;
  moved.head.position = Vec3(0, 0.5f, 0);
  for (Vec3& p : moved.positions) p += moved.head.position;
  const PictureGeometry raised = renderer_->geometry(moved);
  ASSERT_EQ(raised.positions.size(), geometry.positions.size());
  for (size_t v = 0; v < raised.positions.size(); ++v)
    EXPECT_NEAR((raised.positions[v] - geometry.positions[v] - moved.head.position).norm(), 0, 1e-5);
  EXPECT_NEAR(raised.body.positions[0].y(), 0.6f, 1e-6);
}

TEST_F(TracedPictures, PixelsAreThoseOfTheRenderersCamera) {
  TraceOptions options;
  PathScene one = scene(options);
  const Vec3 place(0.03f, 0.04f, -0.02f);
  one.meshes.clear();
  one.hair = {};
  one.hair.offsets = {0, 2};
  one.hair.positions = {place - Vec3(0.02f, 0, 0), place + Vec3(0.02f, 0, 0)};
  one.hair.tangents = {Vec3::UnitX(), Vec3::UnitX()};
  one.hair.radii = {0.02f, 0.02f};
  one.hair.absorption.resize(1, {Vec3(Vec3::Zero()), Vec3(Vec3::Zero())});
  one.width = 48;
  one.backdrop.clear();
  PathFilm film(48, 32);
  PathTracer(std::move(one)).trace(film, 64);
  const FloatImage image = film.image();
  double x = 0, y = 0, sum = 0;
  for (size_t i = 0; i < film.size(); ++i) {
    const double hair = static_cast<double>(image.find("hair")->at(i));
    x += hair * (static_cast<double>(i % 48) + 0.5);
    y += hair * (static_cast<double>(i / 48) + 0.5);
    sum += hair;
  }
  const PicturePoint wanted = *projected(camera_, place, 1.5f);
  ASSERT_GT(sum, 8);
  EXPECT_NEAR(x / sum, 48 * wanted.x, 0.2);
  EXPECT_NEAR(y / sum, 32 * wanted.y, 0.2);
}

TEST_F(TracedPictures, TheBackdropAndTheMeanOfTheGroundAreTheRenderers) {
  settings_.width = settings_.height = 64;
  settings_.lights[0].casts_shadow = false;
  renderer_->setSettings(settings_);
  renderer_->setGroom({});
  renderer_->draw(GuideFrame{}, camera_);
  const Image drawn = renderer_->read();
  groom_ = {};
  TraceOptions options;
  options.spp = 64;
  const Image traced = trace(options).image;
  ASSERT_EQ(traced.rgb.size(), drawn.rgb.size());
  for (int x = 0; x < 64; ++x)  // the top row shows the backdrop, the bottom row the ground
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(traced.rgb[static_cast<size_t>(3 * x + c)], drawn.rgb[static_cast<size_t>(3 * x + c)], 1);
  double sums[2] = {};
  for (int x = 0; x < 64; ++x) {
    sums[0] += linearValue(drawn, x, 63, 1);
    sums[1] += linearValue(traced, x, 63, 1);
  }
  EXPECT_NEAR(sums[1] / sums[0], 1, 0.06);
  std::filesystem::remove(file_);
}

TEST_F(TracedPictures, AnInterruptedPictureContinuesToTheSameBits) {
  TraceOptions options;
  options.spp = 20;
  const TracedPicture whole = trace(options);
  EXPECT_TRUE(whole.is_finished);
  EXPECT_EQ(whole.samples, 20u * 32 * 32);
  const FloatImage wanted = readExr(file_);
  options.resume = true;
  EXPECT_TRUE(trace(options).was_there);
  options.seed = 2;
  EXPECT_FALSE(trace(options).was_there);

  options.seed = 1;
  g_interrupted = true;
  const TracedPicture stopped = trace(options);
  g_interrupted = false;
  EXPECT_FALSE(stopped.is_finished);
  EXPECT_LT(stopped.samples, whole.samples);
  std::filesystem::path checkpoint = file_;
  checkpoint.replace_extension(".checkpoint");
  ASSERT_TRUE(std::filesystem::exists(checkpoint));
  options.max_bounces = 3;
  expectError([&] { trace(options); }, {"checkpoint is of another picture", checkpoint.string()});
  options.max_bounces = 0;
  EXPECT_TRUE(trace(options).is_finished);
  EXPECT_FALSE(std::filesystem::exists(checkpoint));
  const FloatImage resumed = readExr(file_);
  for (size_t c = 0; c < wanted.channels.size(); ++c)
    EXPECT_EQ(resumed.channels[c].values, wanted.channels[c].values) << wanted.channels[c].name;
  std::filesystem::remove(file_);
}

TEST_F(TracedPictures, NoiseEndsWhereItIsReached) {
  TraceOptions options;
  options.noise = 0.05;
  const TracedPicture picture = trace(options);
  EXPECT_TRUE(picture.is_finished);
  EXPECT_LE(picture.error, 0.05);
  EXPECT_GT(picture.error, 0.02);
  std::filesystem::remove(file_);
}

TEST(ExposureGains, WhiteBalanceMakesItsColourNeutral) {
  RenderSettings settings;
  EXPECT_EQ(exposureGains(settings), Vec3(1, 1, 1));
  settings.exposure = 2;
  settings.white_balance = Vec3(1, 0.8f, 0.5f);
  const Vec3 shown = exposureGains(settings).cwiseProduct(settings.white_balance);
  EXPECT_NEAR(shown.x(), shown.y(), 1e-6);
  EXPECT_NEAR(shown.z(), shown.y(), 1e-6);
  EXPECT_NEAR(exposureGains(settings).y(), 4, 1e-6);
}

}  // namespace
}  // namespace strandcast
