#include <algorithm>
#include <chrono>
#include <limits>

#include "core/error.h"
#include "gl/context.h"
#include "gl/program.h"
#include "gl/timers.h"
#include "offscreen.h"
#include "render/framebuffer.h"

namespace strandcast {
namespace {

using RendererInput = OffscreenTest;
using PassTimes = OffscreenTest;

// llvmpipe's own time stamps cover only the last tile, here at most an eighth.
TEST_F(PassTimes, OfASoftwareRendererAreWholeAndOfThePassThatTookThem) {
  if (!gl::currentIsSoftware()) GTEST_SKIP() << "of a GPU the processor's clock tells too much";
  const gl::Program slow(
      "slow", {{GL_VERTEX_SHADER,
                "#version 450\nvoid main() {"
                " gl_Position = vec4(4.0 * vec2(gl_VertexID & 1, gl_VertexID >> 1) - 1.0, 0.0, 1.0); }"},
               {GL_FRAGMENT_SHADER,
                "#version 450\nout vec4 color; void main() { float s = gl_FragCoord.x;"
                " for (int i = 0; i < 50; ++i) s = fract(s * 1.37 + 0.1); color = vec4(s); }"}});
  const PictureBuffer picture(512, 512, 1);  // 64 tiles
  picture.bindForDrawing();
  GLuint no_vertices = 0;
  glCreateVertexArrays(1, &no_vertices);
  glBindVertexArray(no_vertices);
  slow.use();
  gl::PassClock clock;
  std::chrono::steady_clock::time_point begin;
  for (int again = 0; again < 2; ++again) {  // the first run compiles
    glFinish();
    begin = std::chrono::steady_clock::now();
    clock.restart();
    clock.stamp();
    glDrawArrays(GL_TRIANGLES, 0, 3);
    clock.stamp();
    clock.stamp();
  }
  glFinish();
  const std::chrono::duration<double, std::milli> all = std::chrono::steady_clock::now() - begin;
  EXPECT_GT(clock.milliseconds(0), 0.5 * all.count());
  EXPECT_LT(clock.milliseconds(1), 0.5 * all.count());
  EXPECT_EQ(clock.milliseconds(2), 0) << "there is no third";
  glDeleteVertexArrays(1, &no_vertices);
}

// llvmpipe gives four samples for two or three.
TEST_F(RendererInput, HoweverManySamplesAreAskedForThoseOfTheDeviceAreReported) {
  for (const int wanted : {0, 1, 2, 3, 4, 8, 1000}) {
    const PictureBuffer picture(8, 8, wanted);
    picture.bindForDrawing();
    GLint given = -1;
    glGetIntegerv(GL_SAMPLES, &given);
    EXPECT_EQ(picture.samples(), std::max(given, 1)) << wanted << " asked for";
    EXPECT_TRUE(wanted > 1 || given <= 1) << given;
  }
}

TEST_F(RendererInput, EmptyGroomAndEmptyBodyGiveABackground) {
  Renderer renderer(smallPicture());
  renderer.draw(GuideFrame{}, Camera{});
  renderer.setGroom({});
  renderer.setBody({});
  renderer.draw(GuideFrame{}, Camera{});
  EXPECT_EQ(renderer.read().rgb.size(), 128u * 128 * 3);
  EXPECT_EQ(renderer.statistics().hairs_grown, 0u);
  EXPECT_EQ(renderer.statistics().frames_ignored, 0u);
}

TEST_F(RendererInput, OneGuideOfTwoVerticesGrowsHair) {
  Renderer renderer(smallPicture());
  const GroomDescription groom = verticalBundle(1, 1, 0, 0.1f, 0.2f, 2);
  renderer.setGroom(groom);
  const Image bare = (renderer.draw(GuideFrame{}, Camera{}), renderer.read());
  renderer.draw(restFrame(groom), Camera{});
  EXPECT_EQ(renderer.statistics().hairs_grown, 1000u);
  EXPECT_GT(renderer.statistics().hairs_drawn, 0u);
  EXPECT_EQ(renderer.read().rgb, bare.rgb) << "a frame that does not fit draws the rest shape";
  EXPECT_EQ(renderer.statistics().frames_ignored, 1u);
}

TEST_F(RendererInput, FrameThatDoesNotFitIsCountedAndLeavesThePictureAsItWas) {
  Renderer renderer(smallPicture());
  const GroomDescription groom = verticalBundle(4, 4, 0.01f, 0.1f, 0.2f, 6);
  renderer.setGroom(groom);
  GuideFrame frame = restFrame(groom);
  renderer.draw(frame, Camera{});
  const Image before = renderer.read();
  frame.positions.resize(5);
  renderer.draw(frame, Camera{});
  frame = restFrame(groom);
  frame.head.position.x() = std::numeric_limits<float>::infinity();
  renderer.draw(frame, Camera{});
  EXPECT_EQ(renderer.statistics().frames_ignored, 2u);
  EXPECT_EQ(renderer.read().rgb, before.rgb);
}

TEST_F(RendererInput, GuidesThatAreNotFiniteLoseTheirHairsOnly) {
  RenderSettings settings = smallPicture();
  const GroomDescription groom = verticalBundle(6, 6, 0.01f, 0.1f, 0.2f, 6);
  Renderer renderer(settings);
  renderer.setGroom(groom);
  Camera camera;
  const Image none = [&] {
    GuideFrame frame = restFrame(groom);
    for (Vec3& p : frame.positions) p.y() = std::numeric_limits<float>::quiet_NaN();
    renderer.draw(frame, camera);
    EXPECT_EQ(renderer.statistics().guides_unusable, 36u);
    return renderer.read();
  }();
  GuideFrame frame = restFrame(groom);
  frame.positions[7].x() = std::numeric_limits<float>::infinity();
  renderer.draw(frame, camera);
  EXPECT_EQ(renderer.statistics().guides_unusable, 1u);
  EXPECT_NE(renderer.read().rgb, none.rgb);
  // Without hair the middle of the picture is the background, which has no edges.
  for (int x = 33; x < 95; ++x)
    EXPECT_NEAR(linearValue(none, x, 30, 1), linearValue(none, x - 1, 30, 1), 0.01) << x;
}

TEST_F(RendererInput, DamagedBodyAndWildSettingsAndCamerasDoNoHarm) {
  RenderSettings settings = smallPicture();
  settings.samples = 99;
  settings.segments = 1000;
  settings.hair_width = std::numeric_limits<float>::quiet_NaN();
  settings.lights[0].direction = Vec3::Zero();
  settings.lights[0].color = Vec3::Constant(std::numeric_limits<float>::quiet_NaN());
  Renderer renderer(settings);
  BodyDescription body;
  body.mesh.positions = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, std::numeric_limits<float>::quiet_NaN(), 0)};
  body.mesh.triangles = {{0, 1, 2}, {0, 1, 999}};
  renderer.setBody(body);
  const GroomDescription groom = verticalBundle(4, 4, 0.01f, 0.1f, 0.2f, 6);
  renderer.setGroom(groom);
  Camera camera;
  camera.eye = camera.target;
  renderer.draw(restFrame(groom), camera);
  camera.eye.x() = std::numeric_limits<float>::quiet_NaN();
  camera.vertical_fov = -1;
  renderer.draw(restFrame(groom), camera);
  EXPECT_EQ(renderer.statistics().frames_drawn, 2u);

  GroomDescription damaged = groom;
  damaged.guides.positions.pop_back();
  EXPECT_THROW(renderer.setGroom(damaged), Error);
}

TEST_F(RendererInput, LampsMayBeAnywhere) {
  const GroomDescription groom = verticalBundle(6, 6, 0.01f, 0.1f, 0.2f, 6);
  const auto picture = [&](const Light& light) {
    RenderSettings settings = smallPicture();
    settings.lights = {light};
    Renderer renderer(settings);
    renderer.setGroom(groom);
    renderer.draw(restFrame(groom), Camera{});
    return renderer.read();
  };
  Light light;
  for (const LightKind kind : {LightKind::kPoint, LightKind::kSpot}) {
    light.kind = kind;
    light.intensity = 0;
    const Image dark = picture(light);
    light.intensity = 0.5f;
    // In the middle of the hair, on a vertex of a guide, at the eye, beside it, and far away.
    for (const Vec3& place :
         {Vec3(0, 0, 0), groom.guides.strand(14)[2], Camera{}.eye, Vec3(0, -0.08f, 0.9f), Vec3(0, 90, 0)}) {
      light.position = place;
      light.direction = Vec3(Vec3(0, -0.05f, 0) - place);
      light.intensity = 0.5f + place.squaredNorm();
      EXPECT_NE(picture(light).rgb, dark.rgb) << place.transpose();
    }
    Light wild = light, usual;
    const float nothing = std::numeric_limits<float>::quiet_NaN();
    usual.kind = kind;
    wild.position = wild.direction = Vec3::Constant(nothing);
    wild.cone = wild.cone_edge = wild.intensity = nothing;
    EXPECT_EQ(picture(wild).rgb, picture(usual).rgb);
  }
}

}  // namespace
}  // namespace strandcast
