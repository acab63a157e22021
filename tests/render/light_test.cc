// Lights with a position: brightness of the ground against the inverse-square law, and a ball's shadow
// against its rays.
#include "lamp.h"

#include "offscreen.h"

namespace strandcast {
namespace {

using Vec = Eigen::Vector3d;

class Lamps : public OffscreenTest {
 protected:
  Lamps() {
    settings_ = smallPicture();
    settings_.width = settings_.height = kSize;
    settings_.samples = 1;
    settings_.background = Vec3(0.5f, 0.5f, 0.5f);
    camera_.eye = Vec3(0, 6, 0.5f);
    camera_.target = Vec3(0, kGround, 0);
    camera_.vertical_fov = 0.25f;
  }

  /// A sphere as a body. The ground is at the body's lowest point, with an even colour within 0.15 of four of
  /// its diagonals.
  static BodyDescription bodyOf(const Vec3& center, float radius) {
    BodyDescription body;
    constexpr uint32_t kAround = 64, kAlong = 32;
    for (uint32_t j = 0; j <= kAlong; ++j)
      for (uint32_t i = 0; i <= kAround; ++i) {
        const float polar = static_cast<float>(M_PI) * static_cast<float>(j) / kAlong,
                    turn = 2 * static_cast<float>(M_PI) * static_cast<float>(i) / kAround;
        const Vec3 d(std::sin(polar) * std::sin(turn), std::cos(polar), std::sin(polar) * std::cos(turn));
        body.mesh.positions.push_back(Vec3(center + radius * d));
      }
    for (uint32_t j = 0; j < kAlong; ++j)
      for (uint32_t i = 0; i < kAround; ++i) {
        const uint32_t a = j * (kAround + 1) + i, b = a + kAround + 1;
        body.mesh.triangles.push_back({a, b, a + 1});
        body.mesh.triangles.push_back({a + 1, b, b + 1});
      }
    // Small triangles far apart determine the ground's size and height.
    for (const float side : {-1.0f, 1.0f}) {
      const auto first = static_cast<uint32_t>(body.mesh.positions.size());
      for (const Vec3& p : {Vec3(0, 0, 0), Vec3(0.001f, 0, 0), Vec3(0, 0, 0.001f)})
        body.mesh.positions.push_back(Vec3(Vec3(0.8f * side, kGround, 0.8f * side) + p));
      body.mesh.triangles.push_back({first, first + 1, first + 2});
    }
    return body;
  }

  /// The intersection of a pixel's ray with the ground.
  Vec groundAt(double x, double y) const {
    const Eigen::Matrix4d clip =
        (perspective(camera_.vertical_fov, 1, 0.02f, 50) * viewMatrix(camera_.eye, camera_.target))
            .cast<double>();
    Eigen::Vector4d far = clip.inverse() * Eigen::Vector4d(2 * x / kSize - 1, 1 - 2 * y / kSize, 0.5, 1);
    const Vec eye = camera_.eye.cast<double>(), way = far.head<3>() / far.w() - eye;
    return Vec(eye + way * ((kGround - eye.y()) / way.y()));
  }
  Image draw(const std::vector<Light>& lights, bool shadows, const BodyDescription& body) const {
    RenderSettings settings = settings_;
    settings.lights = lights;
    settings.shadows = shadows;
    Renderer renderer(settings);
    renderer.setBody(body);
    renderer.draw(GuideFrame{}, camera_);
    return renderer.read();
  }
  /// Expected value of one channel of the ground under `lights`.
  static double groundBrightness(const std::vector<Light>& lights, const Vec& place, int channel = 1) {
    constexpr double kSky[] = {0.34, 0.38, 0.45}, kSun[] = {2.3, 2.17, 2.0};
    double sum = kSky[channel];
    for (const Light& light : lights) {
      const Arriving at = arriving(light, place);
      sum += kSun[channel] * static_cast<double>(light.color[channel]) * at.irradiance *
             std::max(at.towards.y(), 0.0);
    }
    return 1 - std::exp(-0.5 * 0.55 * sum);
  }
  /// Distance between a ball's centre and the ray from the ground to `to`, in radii.
  static double passes(const Vec& ground, const Vec3& to, const Vec3& center, float radius) {
    const Vec way = (to.cast<double>() - ground).normalized(), middle = center.cast<double>();
    return (middle - ground - way * std::max(way.dot(middle - ground), 0.0)).norm() /
           static_cast<double>(radius);
  }

  static constexpr int kSize = 160;
  static constexpr float kGround = -1;
  RenderSettings settings_;
  Camera camera_;
};

TEST_F(Lamps, LightTheGroundByTheInverseSquareLawAndWithinTheirCone) {
  const BodyDescription body = bodyOf(Vec3(0, 5, 0), 0.01f);  // outside the view
  const Vec3 place(0.2f, -0.4f, 0.1f);
  Light sharp = spotLight(place, Vec3(-0.3f, -1, -0.2f), 0.5f, 0.4f), soft = sharp, all = sharp;
  sharp.cone_edge = 0;
  soft.cone_edge = 0.5f;
  all.cone_edge = 1;
  for (const Light& light :
       {pointLight(place, 0.4f), pointLight(Vec3(-0.3f, 0, 0.1f), 0.5f), sharp, soft, all}) {
    const Image image = draw({light}, false, body);
    double least = 1, most = 0;
    int compared = 0, missed = 0;
    for (int y = 2; y < kSize; y += 4)
      for (int x = 2; x < kSize; x += 4) {
        const Vec ground = groundAt(x + 0.5, y + 0.5);
        const double expected = groundBrightness({light}, ground), shown = linearValue(image, x, y, 1);
        least = std::min(least, expected);
        most = std::max(most, expected);
        ++compared;
        missed += std::abs(shown - expected) > 0.006;  // tolerance of one sRGB step
      }
    EXPECT_GT(most, 2 * least) << "there is something to see";
    // At a sharp edge the result depends on rounding.
    EXPECT_LE(missed, light.kind == LightKind::kSpot && light.cone_edge == 0 ? compared / 200 : 0)
        << static_cast<int>(light.kind) << " " << light.cone_edge;
  }
}

TEST_F(Lamps, ABallsShadowFallsWhereItsRaysMeetTheBall) {
  const Vec3 center(0.05f, -0.6f, -0.1f);
  constexpr float kRadius = 0.12f;
  const BodyDescription body = bodyOf(center, kRadius);
  const Light narrow = spotLight(Vec3(0.5f, 0.6f, 0.3f), Vec3(-0.45f, -1.2f, -0.4f), 0.3f, 2),
              wide = spotLight(Vec3(0.5f, 0.6f, 0.3f), Vec3(-0.45f, -1.2f, -0.4f), 1.2f, 2);
  // The last light is within the bounding ball of the content.
  for (const Light& light :
       {pointLight(Vec3(3, 6, 2), 40), narrow, wide, pointLight(Vec3(0.15f, -0.2f, 0), 0.4f)}) {
    const Image lit = draw({light}, false, body), shaded = draw({light}, true, body);
    int dark = 0, bright = 0, wrong = 0;
    for (int y = 1; y < kSize; y += 2)
      for (int x = 1; x < kSize; x += 2) {
        const Vec ground = groundAt(x + 0.5, y + 0.5);
        if (passes(ground, camera_.eye, center, kRadius) < 1.05) continue;  // the ball is in front of it
        if (arriving(light, ground).irradiance < 0.05) continue;
        const double off = passes(ground, light.position, center, kRadius);
        if (off > 0.9 && off < 1.15) continue;  // within the map's texel size of the shadow's edge
        const double with = linearValue(shaded, x, y, 1), without = linearValue(lit, x, y, 1);
        const double ambient = 1 - std::exp(-0.5 * 0.55 * 0.38);
        (off < 1 ? dark : bright) += 1;
        wrong += std::abs(with - (off < 1 ? ambient : without)) > 0.01;
      }
    EXPECT_GT(dark, 60);
    EXPECT_GT(bright, 400);
    EXPECT_EQ(wrong, 0) << static_cast<int>(light.kind) << " cone " << light.cone << ": of " << dark
                        << " dark and " << bright << " light places";
  }
}

TEST_F(Lamps, SeveralOfDifferentColorsAddUpEachWithItsOwnShadow) {
  const Vec3 center(0, -0.7f, 0);
  constexpr float kRadius = 0.12f;
  const BodyDescription body = bodyOf(center, kRadius);
  std::vector<Light> lights{pointLight(Vec3(0.6f, 0.4f, 0.2f), 0.5f),
                            pointLight(Vec3(-0.5f, 0.3f, 0.5f), 0.4f),
                            spotLight(Vec3(-0.1f, 0.5f, -0.8f), Vec3(0.1f, -1.2f, 0.8f), 0.4f, 0.9f)};
  lights[0].color = Vec3(1, 0.3f, 0.2f);
  lights[1].color = Vec3(0.2f, 0.4f, 1);
  lights[2].color = Vec3(0.3f, 1, 0.3f);
  const Image image = draw(lights, true, body);
  int shadows[4] = {}, wrong = 0;
  for (int y = 1; y < kSize; y += 2)
    for (int x = 1; x < kSize; x += 2) {
      const Vec ground = groundAt(x + 0.5, y + 0.5);
      if (passes(ground, camera_.eye, center, kRadius) < 1.05) continue;  // the ball is in front of it
      std::vector<Light> reach;
      bool at_an_edge = false;
      for (const Light& light : lights) {
        const double off = passes(ground, light.position, center, kRadius);
        at_an_edge |= off > 0.9 && off < 1.15;
        if (off > 1) reach.push_back(light);
      }
      if (at_an_edge) continue;
      ++shadows[lights.size() - reach.size()];
      for (int channel = 0; channel < 3; ++channel)
        wrong +=
            std::abs(linearValue(image, x, y, channel) - groundBrightness(reach, ground, channel)) > 0.01;
    }
  EXPECT_GT(shadows[0], 1000);
  EXPECT_GT(shadows[1], 300);
  EXPECT_EQ(wrong, 0) << "of places in 0, 1, 2 and 3 shadows: " << shadows[0] << " " << shadows[1] << " "
                      << shadows[2] << " " << shadows[3];
}

}  // namespace
}  // namespace strandcast
