#include "light/path_tracer.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <numbers>
#include <random>

#include "kernels/scalar_picture.h"
#include "tests/expect_error.h"

namespace strandcast {
namespace {

constexpr double kPi = std::numbers::pi;

/// Eye at `eye`, looking at `target`; `up` is not parallel to the view.
TracedCamera cameraAt(const Vec3& eye, const Vec3& target, const Vec3& up = Vec3::UnitY()) {
  const Vec3 back = (eye - target).normalized(), right = up.cross(back).normalized();
  TracedCamera camera;
  camera.view.block<1, 3>(0, 0) = right.transpose();
  camera.view.block<1, 3>(1, 0) = back.cross(right).transpose();
  camera.view.block<1, 3>(2, 0) = back.transpose();
  camera.view.block<3, 1>(0, 3) = -camera.view.block<3, 3>(0, 0) * eye;
  camera.focus = (eye - target).norm();
  return camera;
}

TracedMesh floorMesh(float half) {
  TracedMesh floor;
  floor.mesh.positions = {Vec3(-half, 0, -half), Vec3(half, 0, -half), Vec3(half, 0, half),
                          Vec3(-half, 0, half)};
  floor.mesh.triangles = {{0, 2, 1}, {0, 3, 2}};
  return floor;
}

/// A diffuse floor of albedo 0.5 seen from above.
PathScene floorScene() {
  PathScene scene;
  scene.meshes = {floorMesh(5)};
  scene.materials = {{CoatedDiffuse({0.5, 0.5, 0.5}, 1, 0.5)}};
  scene.camera = cameraAt(Vec3(0, 1, 0.001f), Vec3(0, 0, 0), Vec3::UnitZ());
  scene.camera.vertical_fov = 0.01f;  // all pixels see one place
  scene.width = scene.height = 4;
  return scene;
}

/// A ball of hairs that stand out from its middle, with some curl. Without absorption.
TracedHair hairBall(int hairs, float radius) {
  TracedHair ball;
  std::mt19937 engine(5);
  std::normal_distribution<float> normal;
  constexpr int kSegments = 8;
  for (int h = 0; h < hairs; ++h) {
    Vec3 along = Vec3(normal(engine), normal(engine), normal(engine)).normalized();
    Vec3 point = 0.02f * along;
    for (int i = 0; i <= kSegments; ++i) {
      ball.positions.push_back(point);
      ball.tangents.push_back(along);
      ball.radii.push_back(i < kSegments ? radius : 0.3f * radius);
      along = (along + 0.3f * Vec3(normal(engine), normal(engine), normal(engine))).normalized();
      point += 0.006f * along;
    }
    ball.offsets.push_back(static_cast<uint32_t>(ball.positions.size()));
    ball.absorption.push_back({Vec3(Vec3::Zero()), Vec3(Vec3::Zero())});
  }
  return ball;
}

PathScene ballScene(int hairs = 1500) {
  PathScene scene;
  scene.hair = hairBall(hairs, 4e-4f);
  scene.sky = Sky::constant({1, 1, 1});
  scene.camera = cameraAt(Vec3(0, 0, 0.5f), Vec3(0, 0, 0));
  scene.camera.vertical_fov = 0.2f;
  scene.width = scene.height = 24;
  return scene;
}

Eigen::Array3d meanOf(const PathTracer& tracer, int width, int height, uint32_t samples) {
  PathFilm film(width, height);
  tracer.trace(film, samples);
  Eigen::Array3d sum{0, 0, 0};
  for (size_t i = 0; i < film.size(); ++i) sum += film.radiance(i) / static_cast<double>(film.size());
  return sum;
}

Eigen::Array3d sunOverPi() {
  const kernels::f32::real3 sun = kernels::f32::sunIrradiance();
  return {sun.x, sun.y, sun.z};
}

void expectClose(const Eigen::Array3d& value, const Eigen::Array3d& wanted, double part) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(value[c], wanted[c], part * wanted[c]) << c;
}

TEST(PathTracer, AFloorHasTheRadianceOfEveryLightsIrradiance) {
  PathScene scene = floorScene();
  Light light;
  light.intensity = 2;
  light.direction = Vec3(0, -0.8f, 0.6f);
  scene.lights = {light};
  expectClose(meanOf(PathTracer(scene), 4, 4, 8), 0.5 * 2 * 0.8 * sunOverPi(), 1e-3);

  light.kind = LightKind::kPoint;
  light.position = Vec3(0, 2, 0);
  scene.lights = {light};
  expectClose(meanOf(PathTracer(scene), 4, 4, 8), 0.5 * 2 / 4.0 * sunOverPi(), 1e-3);

  light.kind = LightKind::kSpot;  // its axis is 36.9 degrees away, outside the cone, then inside
  light.cone = 0.5f;
  scene.lights = {light};
  EXPECT_EQ(meanOf(PathTracer(scene), 4, 4, 8).maxCoeff(), 0);
  light.direction = -Vec3::UnitY();
  scene.lights = {light};
  expectClose(meanOf(PathTracer(scene), 4, 4, 8), 0.5 * 2 / 4.0 * sunOverPi(), 1e-3);
}

TEST(PathTracer, ARectanglesIrradianceIsThatOfItsFormula) {
  PathScene scene = floorScene();
  Light light;
  light.kind = LightKind::kRectangle;
  light.position = Vec3(0, 1, 0);
  light.direction = -Vec3::UnitY();
  light.width = 1.6f;
  light.height = 0.9f;
  scene.lights = {light};
  // Form factor from a point to a parallel rectangle about its axis: four quarters (Howell, C-11).
  const double a = 0.8, b = 0.45, x = std::sqrt(1 + a * a), y = std::sqrt(1 + b * b);
  const double form = 4 / (2 * kPi) * (a / x * std::atan(b / x) + b / y * std::atan(a / y));
  const Eigen::Array3d radiance = kPi * sunOverPi() / (1.6 * 0.9);
  expectClose(meanOf(PathTracer(scene), 4, 4, 4000), 0.5 * radiance * form, 0.01);
  light.casts_shadow = false;  // then it is never met by chance
  scene.lights = {light};
  expectClose(meanOf(PathTracer(scene), 4, 4, 4000), 0.5 * radiance * form, 0.01);
}

TEST(PathTracer, HairShadesTheFloorUnlessTheLightCastsNoShadow) {
  PathScene scene = floorScene();
  scene.camera = cameraAt(Vec3(0.3f, 0.2f, 0), Vec3(0, 0, 0));  // sees below the hair
  scene.camera.vertical_fov = 0.001f;
  scene.hair = hairBall(1, 0.09f);
  scene.hair.positions.clear();
  scene.hair.tangents.clear();
  scene.hair.radii.clear();
  scene.hair.offsets = {0, 2};
  scene.hair.positions = {Vec3(-1, 0.5f, 0), Vec3(1, 0.5f, 0)};
  scene.hair.tangents = {Vec3::UnitX(), Vec3::UnitX()};
  scene.hair.radii = {0.05f, 0.05f};
  scene.max_bounces = 1;
  Light light;
  light.direction = -Vec3::UnitY();
  scene.lights = {light};
  EXPECT_EQ(meanOf(PathTracer(scene), 4, 4, 4).maxCoeff(), 0);
  scene.lights[0].casts_shadow = false;
  expectClose(meanOf(PathTracer(scene), 4, 4, 4), 0.5 * sunOverPi(), 1e-3);
}

/// Mean radiance of green over the pixels, weighted by their share of hair.
double meanOverHair(const PathScene& scene, uint32_t samples) {
  PathFilm film(scene.width, scene.height);
  PathTracer(scene).trace(film, samples);
  const FloatImage image = film.image();
  double sum = 0, weight = 0;
  for (size_t i = 0; i < film.size(); ++i) {
    const double hair = static_cast<double>(image.find("hair")->at(i));
    sum += hair * film.radiance(i)[1];
    weight += hair;
  }
  EXPECT_GT(weight, 100);
  return sum / weight;
}

TEST(PathTracer, WhiteHairInAWhiteFurnaceIsWhite) {
  PathScene scene = ballScene();
  for (const double tilt : {0.0, 0.087}) {
    scene.fibre.tilt = tilt;
    EXPECT_NEAR(meanOverHair(scene, 50), 1, 0.003) << tilt;
  }
  // Uniform directions have a variance that only rough fibres keep small: 0.4 % here.
  scene.first_direction = FirstDirection::kUniform;
  scene.fibre.longitudinal_roughness = scene.fibre.azimuthal_roughness = 0.8;
  EXPECT_NEAR(meanOverHair(scene, 300), 1, 0.015);
}

TEST(PathTracer, ASkyPictureGivesTheSameAsUniformFirstDirections) {
  PathScene scene = ballScene(300);
  FloatImage sky{16, 8, {{"R", {}}, {"G", {}}, {"B", {}}}, {}};
  for (size_t c = 0; c < 3; ++c) {
    sky.channels[c].values.assign(128, 0.2f);
    sky.channels[c].values[c == 0 ? 20 : 90] = 40;
  }
  scene.sky = Sky::picture(sky, 1, "picture");
  scene.backdrop.assign(24 * 24, Eigen::Array3f(0, 0, 0));
  for (auto& end : scene.hair.absorption) end = {Vec3(0.1f, 0.3f, 0.6f), Vec3(0.05f, 0.2f, 0.9f)};
  const Eigen::Array3d by_importance = meanOf(PathTracer(scene), 24, 24, 150);
  scene.first_direction = FirstDirection::kUniform;
  expectClose(meanOf(PathTracer(scene), 24, 24, 900), by_importance, 0.03);
}

TEST(PathTracer, PixelsDoNotDependOnThreadsNorOnInterruptions) {
  const PathScene scene = ballScene(400);
  const PathTracer tracer(scene);
  PathFilm reference(24, 24);
  tracer.trace(reference, 12);
  {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    const PathTracer again(scene);
    PathFilm film(24, 24);
    again.trace(film, 12);
    EXPECT_EQ(film.image().channels[0].values, reference.image().channels[0].values);
  }
  PathFilm stopped(24, 24);
  int calls = 0;
  EXPECT_FALSE(tracer.trace(stopped, 7, [&](uint64_t) { return ++calls < 2; }));
  EXPECT_LT(stopped.allSamples(), 24u * 24 * 7);
  const std::string file = std::string(STRANDCAST_BINARY_DIR) + "/path_tracer_test.checkpoint";
  stopped.save(file, 99, 7);
  PathFilm resumed(24, 24);
  EXPECT_EQ(resumed.restore(file, 99), 7u);
  EXPECT_EQ(resumed.allSamples(), stopped.allSamples());
  EXPECT_TRUE(tracer.trace(resumed, 12));
  const FloatImage all = resumed.image(), wanted = reference.image();
  for (size_t c = 0; c < wanted.channels.size(); ++c)
    EXPECT_EQ(all.channels[c].values, wanted.channels[c].values) << wanted.channels[c].name;

  expectError([&] { resumed.restore(file, 98); }, {"checkpoint is of another picture", file});
  expectError([&] { PathFilm(24, 23).restore(file, 99); }, {"checkpoint is of another picture", file});
  std::ofstream(file) << "no checkpoint";
  expectError([&] { resumed.restore(file, 99); }, {"this is no checkpoint", file});
  EXPECT_EQ(resumed.allSamples(), 24u * 24 * 12);
  std::remove(file.c_str());
}

TEST(PathTracer, TheSeedChangesTheNoiseWhichTheHalfBuffersEstimate) {
  PathScene scene = ballScene(400);
  PathFilm films[2] = {PathFilm(24, 24), PathFilm(24, 24)};
  for (size_t i = 0; i < 2; ++i) {
    scene.seed = i + 1;
    scene.lights = std::vector<Light>(1);
    PathTracer(scene).trace(films[i], 40);
  }
  double squares = 0, sum = 0;
  size_t met = 0;
  const FloatImage image = films[0].image();
  for (size_t i = 0; i < films[0].size(); ++i) {
    if (!(image.find("hair")->at(i) > 0)) continue;
    squares += ((films[0].radiance(i) - films[1].radiance(i)) / std::sqrt(2.0)).square().mean();
    sum += films[0].radiance(i).mean();
    ++met;
  }
  const double wanted = std::sqrt(squares / static_cast<double>(met)) / (sum / static_cast<double>(met));
  EXPECT_GT(wanted, 0);
  EXPECT_NEAR(films[0].relativeError() / wanted, 1, 0.35);
  EXPECT_NEAR(films[0].relativeError() / films[1].relativeError(), 1, 0.35);
}

TEST(PathTracer, ChannelsSumUpAndBounceLimitsLeaveOutTheRest) {
  PathScene scene = ballScene(400);
  scene.lights = std::vector<Light>(1);
  PathFilm film(24, 24);
  PathTracer(scene).trace(film, 8);
  const FloatImage image = film.image();
  scene.max_bounces = 1;
  PathFilm once(24, 24);
  PathTracer(scene).trace(once, 8);
  const FloatImage limited = once.image();
  double multiple = 0;
  for (size_t i = 0; i < film.size(); ++i) {
    if (image.find("hair")->at(i) == 1.0f) {
      EXPECT_NEAR(image.find("R")->at(i), image.find("single.R")->at(i) + image.find("multiple.R")->at(i),
                  1e-5);
    }
    EXPECT_EQ(limited.find("multiple.R")->at(i), 0);
    EXPECT_NEAR(limited.find("single.R")->at(i), image.find("single.R")->at(i), 1e-6);
    multiple += static_cast<double>(image.find("multiple.R")->at(i));
    EXPECT_EQ(image.find("spp")->at(i), 8);
  }
  EXPECT_GT(multiple, 1);
  EXPECT_NEAR(image.find("Z")->at(12 * 24 + 12), 0.5, 0.09);
  EXPECT_TRUE(std::isinf(image.find("Z")->at(0)));
}

TEST(PathTracer, ALensBlursWhatIsOutOfFocusOnly) {
  PathScene scene = ballScene(1);
  scene.hair.offsets = {0, 2};
  scene.hair.positions = {Vec3(0, -1, 0), Vec3(0, 1, 0)};
  scene.hair.tangents = {Vec3::UnitY(), Vec3::UnitY()};
  scene.hair.radii = {0.004f, 0.004f};
  scene.max_bounces = 1;
  const auto covered = [&](float lens, float focus) {
    scene.camera.lens_radius = lens;
    scene.camera.focus = focus;
    PathFilm film(24, 24);
    PathTracer(scene).trace(film, 64);
    int touched = 0;
    double share = 0;
    const FloatImage image = film.image();
    for (size_t x = 0; x < 24; ++x) {
      touched += image.find("hair")->at(12 * 24 + x) > 0;
      share += static_cast<double>(image.find("hair")->at(12 * 24 + x));
    }
    EXPECT_NEAR(share, 0.008 / (2 * 0.5 * std::tan(0.1)) * 24, 0.35);
    return touched;
  };
  const int sharp = covered(0, 0.5f);
  EXPECT_LE(sharp, 4);
  EXPECT_NEAR(covered(0.02f, 0.5f), sharp, 1);
  EXPECT_GT(covered(0.02f, 0.25f), 2 * sharp);
}

TEST(PathTracer, RefusesAPictureThatCannotBeTraced) {
  PathScene scene = floorScene();
  scene.meshes[0].material = 1;
  expectError([&] { PathTracer tracer(scene); }, {"a surface has no material"});
  scene = floorScene();
  scene.lights = std::vector<Light>(1);
  scene.lights[0].direction = Vec3::Zero();
  expectError([&] { PathTracer tracer(scene); }, {"light has no direction"});
  scene = floorScene();
  scene.fibre.longitudinal_roughness = 0;
  expectError([&] { PathTracer tracer(scene); }, {"longitudinal roughness is 0"});
  scene = floorScene();
  scene.camera.focus = 0;
  expectError([&] { PathTracer tracer(scene); }, {"lens is invalid"});
}

}  // namespace
}  // namespace strandcast
