// Kajiya-Kay shading of a bundle bent over a cylinder, against the same formula on the CPU.
#include <numbers>

#include "lamp.h"
#include "offscreen.h"
#include "render/hair_growth.h"

namespace strandcast {
namespace {

using Vec = Eigen::Vector3d;
constexpr double kRadius = 0.1, kTop = 1.5, kBottom = -0.6;  // m; rad above the horizon

GroomDescription bentBundle() {
  GroomDescription groom;
  for (int x = 0; x < 200; ++x) {
    std::vector<Vec3> points;
    for (int i = 0; i < 60; ++i) {
      const double a = kTop + (kBottom - kTop) * i / 59;
      points.emplace_back(0.0005f * (static_cast<float>(x) - 99.5f),
                          static_cast<float>(kRadius * std::sin(a)),
                          static_cast<float>(kRadius * std::cos(a)));
    }
    groom.guides.append(points);
  }
  return groom;
}

double lobe(double il, double ie, double shift, double exponent) {
  return std::pow(std::max(std::cos(il + ie - 2 * shift), 0.0), exponent);
}

/// Green channel of a hair's radiance without shadows: hair_shading.glsl in double precision.
double radiance(const RenderSettings& s, const Hair& hair, const Vec& position, const Vec& t, const Vec& eye,
                double along) {
  const Arriving light = arriving(s.lights[0], position);
  const Vec l = light.towards, e = (eye - position).normalized();
  const double tl = t.dot(l), te = t.dot(e), sine = std::sqrt(1 - tl * tl);
  const Vec la = l - tl * t, ea = e - te * t;
  const double front = std::sqrt(0.5 + 0.5 * la.normalized().dot(ea.normalized()));
  Eigen::Array3d colors =
      s.hair_color.cast<double>().array() * (1 + 0.35 * hair.shade) * (0.75 + 0.5 * along);
  colors *= Eigen::Array3d(1 + 0.1 * hair.warmth, 1, 1 - 0.1 * hair.warmth);
  colors /= std::max(colors.maxCoeff(), 1.0);
  const double base = colors.y(), brightest = colors.maxCoeff();
  const double whole = brightest * (1.26 + 0.98 * std::sqrt(brightest)) + 0.07;
  const double factor = std::pow(1 + std::pow(whole, 8), -0.125);
  const double outer = lobe(std::asin(tl), std::asin(te), -0.06, 60) * front;
  const double inner = lobe(std::asin(tl), std::asin(te), 0.10, 14) * (0.3 + 0.7 * front);
  const double specular = 0.17 * outer + 1.1 * std::sqrt(base) * base * inner;
  const double rise = std::clamp(along / 0.25, 0.0, 1.0),
               occlusion = 0.45 + 0.55 * rise * rise * (3 - 2 * rise);
  const double ambient = 0.13 + (0.38 - 0.13) * (0.5 + 0.5 * ea.normalized().y());
  return 2.17 * light.irradiance * factor * (0.5 * base * sine * (0.45 + 0.55 * front) + specular * sine) +
         base * ambient * occlusion * 0.65;
}

using LightOnHair = OffscreenTest;

Light sun() {
  Light light;
  light.direction = Vec3(0, -0.5f, -1);
  return light;
}

struct HighlightError {
  int peak = 0;      ///< displacement of the highlight, rows
  double worst = 0;  ///< largest relative error of a row's brightness
};
HighlightError highlightError(RenderSettings settings, int segments, HairShading shading,
                              const Light& light) {
  settings.width = settings.height = 256;
  settings.growth.hairs = 2000;
  settings.segments = segments;
  settings.shading = shading;
  settings.hair_width = 1e-3f;             // covers the bundle
  settings.growth.clump_radius = 1.5e-4f;  // so that tangents are the guides'
  settings.growth.tip_deviation = settings.growth.whole_deviation = 0;
  settings.shadows = false;
  settings.lights = {light};
  Renderer renderer(settings);
  const GroomDescription groom = bentBundle();
  renderer.setGroom(groom);
  Camera camera;
  camera.eye = Vec3(0, 0.05f, 4);
  camera.target = Vec3(0, 0.05f, 0);
  camera.vertical_fov = 0.04f;
  renderer.draw(restFrame(groom), camera);
  const Image image = renderer.read();

  const std::vector<Hair> hairs = growHairs(groom.guides, settings.growth);
  const Vec eye = camera.eye.cast<double>();
  const double half_height = 4 * std::tan(0.02);
  int measured_peak = 0, expected_peak = 0;
  double measured_most = 0, expected_most = 0, worst = 0;
  int rows = 0;
  for (int y = 0; y < 256; ++y) {
    double height = 0;  // of the intersection of the row's ray with the cylinder
    for (int i = 0; i < 8; ++i) {
      const double depth = std::sqrt(std::max(kRadius * kRadius - height * height, 0.0));
      height = 0.05 + half_height * (1 - 2 * (y + 0.5) / 256) * (4 - depth) / 4;
    }
    const double sine = height / kRadius;
    if (sine > 0.85 || sine < -0.15) continue;  // excludes the outline and the thinning tips
    const double a = std::asin(sine), along = (kTop - a) / (kTop - kBottom);
    const Vec position(0, height, kRadius * std::cos(a)), tangent(0, -std::cos(a), std::sin(a));
    double expected = 0, measured = 0;
    for (const Hair& hair : hairs)
      expected += (1 - std::exp(-radiance(settings, hair, position, tangent, eye, along / hair.extent))) /
                  hairs.size();
    for (int x = 100; x < 156; ++x) measured += linearValue(image, x, y, 1) / 56;
    worst = std::max(worst, std::abs(measured / expected - 1));
    if (measured > measured_most) measured_most = measured, measured_peak = y;
    if (expected > expected_most) expected_most = expected, expected_peak = y;
    ++rows;
  }
  EXPECT_GT(rows, 100);
  return {std::abs(measured_peak - expected_peak), worst};
}

TEST_F(LightOnHair, HighlightOfABentBundleIsWhereAndAsBrightAsTheFormulaSays) {
  // Lamps so near that the distance matters; the spot's edge is on the bundle.
  const Vec3 lamp(0, 0.25f, 0.35f);
  for (const Light& light :
       {sun(), pointLight(lamp, 0.05f), spotLight(lamp, Vec3(0, -0.7f, -1), 0.25f, 0.1f)}) {
    for (const HairShading shading : {HairShading::kVertex, HairShading::kFragment}) {
      // Many nodes, because the highlight is narrow.
      const HighlightError error = highlightError(smallPicture(), 64, shading, light);
      EXPECT_LE(error.peak, 3) << static_cast<int>(light.kind);
      // Strands average over 56 columns; their shades vary by a fifth.
      EXPECT_LT(error.worst, 0.08) << static_cast<int>(light.kind);
    }
  }
}

/// Fraction of the light perpendicular to a grey hair that it scatters, by scattered() of hair_shading.glsl
/// without energyFactor().
double scatteredPart(double base) {
  constexpr int kParts = 300;
  constexpr double kPi = std::numbers::pi;
  double sum = 0;
  for (int i = 0; i < kParts; ++i) {
    const double ie = kPi * ((i + 0.5) / kParts - 0.5);
    for (int j = 0; j < kParts; ++j) {
      const double front = std::cos(kPi * ((j + 0.5) / kParts - 0.5));
      const double radiance = 0.5 * base * (0.45 + 0.55 * front) + 0.17 * lobe(0, ie, -0.06, 60) * front +
                              1.1 * std::pow(base, 1.5) * lobe(0, ie, 0.10, 14) * (0.3 + 0.7 * front);
      sum += radiance * std::pow(std::cos(ie), 2) / kPi * (kPi / kParts) * (2 * kPi / kParts);
    }
  }
  return sum;
}

TEST(ScatteredLight, IsAllThatArrivesAtMostAndThatOfDarkHairIsLeftAsItIs) {
  for (const double base : {0.05, 0.17, 0.3, 0.5, 0.7, 1.0}) {
    const double whole = base * (1.26 + 0.98 * std::sqrt(base)) + 0.07,
                 factor = std::pow(1 + std::pow(whole, 8), -0.125);
    EXPECT_NEAR(whole, scatteredPart(base), 0.02) << base;
    EXPECT_LE(factor * scatteredPart(base), 1.001) << base;
    EXPECT_GT(factor, base <= 0.3 ? 0.995 : 0) << base;
  }
}

TEST_F(LightOnHair, OfWhiteHairIsAsTheFormulaSays) {
  RenderSettings settings = smallPicture();
  settings.hair_color = Vec3(0.95f, 0.9f, 0.8f);
  const HighlightError error = highlightError(settings, 64, HairShading::kFragment, sun());
  EXPECT_LT(error.worst, 0.08);
}

TEST_F(LightOnHair, IsNearerToTheFormulaInEveryFragmentWhereHairHasFewSegments) {
  const HighlightError vertex = highlightError(smallPicture(), 12, HairShading::kVertex, sun()),
                       fragment = highlightError(smallPicture(), 12, HairShading::kFragment, sun());
  EXPECT_LE(fragment.peak, 3);
  EXPECT_LT(fragment.worst, 0.6 * vertex.worst);
}

}  // namespace
}  // namespace strandcast
