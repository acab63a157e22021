#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "air/wind_grid.h"

namespace strandcast {
namespace {

using Grid = WindGrid<float>;

constexpr double kTimeStep = 1.0 / 60;

WindSource sphere(const Vec3& position, float radius, float speed) {
  WindSource source;
  source.kind = WindSource::Kind::kSphere;
  source.position = position;
  source.radius = radius;
  source.speed = speed;
  return source;
}

// Outflow of a sphere, m^3/s.
double flowOf(const WindSource& source) {
  const double radius = static_cast<double>(source.radius);
  return 4 * std::numbers::pi * radius * radius * static_cast<double>(source.speed);
}

// Evenly distributed directions.
std::vector<Vec3> directions() {
  std::vector<Vec3> out;
  constexpr int kCount = 200;
  for (int n = 0; n < kCount; ++n) {
    const double z = 1 - (2 * n + 1.0) / kCount, turn = 2.39996322972865 * n, by = std::sqrt(1 - z * z);
    out.emplace_back(by * std::cos(turn), by * std::sin(turn), z);
  }
  return out;
}

PressureReport blow(Grid& grid, const std::vector<WindSource>& sources, int steps = 1) {
  PressureReport report;
  for (int step = 0; step < steps; ++step) {
    grid.setSources(sources);
    grid.advect(kTimeStep, false);
    grid.exchange(kTimeStep);
    report = grid.project();
  }
  return report;
}

// Closed walls of solid cells around the middle, 0.6 m wide inside, in a box of 1.6 m. `open`: without the
// wall at high x.
void enclose(Grid& grid, bool open) {
  grid.clearSolids();
  grid.addSolid(
      Box(Eigen::Vector3f(-0.6f, -0.6f, -0.6f), Eigen::Vector3f(0.6f, 0.6f, 0.6f)),
      [&](std::span<const Vec3> points, float* out) {
        for (const Vec3& x : points) {
          const float wall = std::fabs(x.cwiseAbs().maxCoeff() - 0.4f) - 0.101f;
          *out++ = open ? std::max(wall, x.x() - 0.25f) : wall;
        }
      },
      [](const Vec3&) { return Vec3(Vec3::Zero()); });
}

TEST(SphereSource, LetsOutItsAirWhateverTheCellAndWhereverItIsInIt) {
  const Workers workers(1);
  for (const int cells : {16, 32})
    for (const float radius : {0.01f, 0.04f, 0.1f, 0.3f})
      for (const float speed : {3.0f, -2.0f})
        for (const Vec3& at : {Vec3(0, 0, 0), Vec3(0.013f, -0.021f, 0.037f)}) {
          Grid grid(simdPasses(), workers, cells, 1.2f / static_cast<float>(cells), Grid::Border::kOpen);
          grid.centreAt(Vec3::Zero());
          const WindSource source = sphere(at, radius, speed);
          blow(grid, {source});
          EXPECT_NEAR(grid.flowOut() / flowOf(source), 1, 2e-3) << cells << ' ' << radius << ' ' << speed;
          EXPECT_LT(grid.largestOutflow(), 1e-3 * grid.fastest()) << cells << ' ' << radius;
        }
}

// Compared at twice the radius.
TEST(SphereSource, BlowsAsExactFlowInAllDirections) {
  const Workers workers(1);
  double errors[2] = {};
  for (const int doubled : {0, 1}) {
    const int cells = 24 << doubled;
    Grid grid(simdPasses(), workers, cells, 1.2f / static_cast<float>(cells), Grid::Border::kOpen);
    grid.centreAt(Vec3::Zero());
    const WindSource source = sphere(Vec3(0.013f, -0.021f, 0.007f), 0.1f, 3);
    blow(grid, {source});
    for (const Vec3& way : directions()) {
      const Vec3 exact = way * (source.speed / 4);
      errors[doubled] += double{(grid.velocityAt(source.position + 0.2f * way) - exact).squaredNorm()};
    }
    errors[doubled] = std::sqrt(errors[doubled] / 200) / 0.75;
  }
  EXPECT_LT(errors[0], 0.05);
  EXPECT_GT(std::log2(errors[0] / errors[1]), 1.2);
}

TEST(SphereSource, KeepsBlowingAndItsSpeedStaysWhatItIs) {
  const Workers workers(1);
  Grid grid(simdPasses(), workers, 48, 0.8f / 48, Grid::Border::kOpen);
  grid.centreAt(Vec3::Zero());
  const WindSource source = sphere(Vec3(0.013f, -0.021f, 0.007f), 0.1f, 3);
  blow(grid, {source}, 60);
  double mean = 0;
  for (const Vec3& way : directions())
    mean += double{grid.velocityAt(source.position + 0.2f * way).dot(way)} / 200;
  EXPECT_NEAR(mean, 0.75, 0.01);
  EXPECT_NEAR(grid.flowOut() / flowOf(source), 1, 5e-3);
  EXPECT_LT(grid.largestOutflow(), 1e-3 * grid.fastest());
  blow(grid, {}, 1);
  EXPECT_NEAR(grid.flowOut(), 0, 1e-3 * flowOf(source)) << "switched off";
}

TEST(SphereSource, BlowsWhereItIsWhileItMovesAndTheGridMovesToo) {
  const Workers workers(1);
  Grid grid(simdPasses(), workers, 32, 0.0375f, Grid::Border::kOpen);
  for (int step = 0; step < 20; ++step) {
    const Vec3 at(0.017f * static_cast<float>(step), 0.01f, 0);
    if (step == 12) grid.moveOrigin(Vec3(0.1f, 0, 0));
    const Vec3 seen = step < 12 ? at : Vec3(at - Vec3(0.1f, 0, 0));
    grid.centreAt(seen);
    const WindSource source = sphere(seen, 0.1f, 2);
    blow(grid, {source});
    ASSERT_NEAR(grid.flowOut() / flowOf(source), 1, 5e-3) << step;
    ASSERT_GT(grid.velocityAt(seen + Vec3(0, 0.12f, 0)).y(), 0.5f) << step;
    ASSERT_LT(grid.velocityAt(seen - Vec3(0, 0.12f, 0)).y(), -0.5f) << step;
  }
}

TEST(SphereSource, HalfBeyondTheBorderBlowsHalf) {
  const Workers workers(1);
  Grid grid(simdPasses(), workers, 32, 0.0375f, Grid::Border::kOpen);
  grid.centreAt(Vec3::Zero());
  const WindSource source = sphere(Vec3(grid.origin().x(), 0, 0), 0.2f, 2);
  blow(grid, {source});
  EXPECT_NEAR(grid.flowOut() / flowOf(source), 0.5, 0.01);
  blow(grid, {sphere(Vec3(3e38f, 0, 0), 0.2f, 2)}, 3);
  EXPECT_NEAR(grid.flowOut(), 0, 1e-4) << "far away";
}

// Wind passes through the sphere; the emitted air has no momentum of its own.
TEST(SphereSource, SlowsTheWindThatGoesThroughIt) {
  const Workers workers(1);
  Grid grid(simdPasses(), workers, 32, 0.025f, Grid::Border::kOpen);
  Parameters parameters;
  parameters.wind = Vec3(2, 0, 0);
  grid.ambient().configure(parameters);
  grid.centreAt(Vec3::Zero());
  grid.reset();
  blow(grid, {sphere(Vec3::Zero(), 0.1f, 3)}, 60);
  EXPECT_LT(grid.velocityAt(Vec3::Zero()).x(), 1.5f);
  EXPECT_GT(grid.velocityAt(Vec3(0.2f, 0, 0)).x(), grid.velocityAt(Vec3(-0.2f, 0, 0)).x() + 0.5f);
}

TEST(SphereSource, SolidCellsKeepTheirShare) {
  const Workers workers(1);
  Grid grid(simdPasses(), workers, 32, 0.0375f, Grid::Border::kOpen);
  grid.centreAt(Vec3::Zero());
  const WindSource source = sphere(Vec3::Zero(), 0.2f, 2);
  const auto cover = [&](float from) {
    grid.clearSolids();
    grid.addSolid(
        Box(Eigen::Vector3f(-0.5f, -0.3f, -0.3f), Eigen::Vector3f(0.5f, 0.3f, 0.3f)),
        [&](std::span<const Vec3> points, float* out) {
          for (const Vec3& x : points)
            *out++ = std::max({x.x() - 0.4f, from - x.x(), std::fabs(x.y()) - 0.3f, std::fabs(x.z()) - 0.3f});
        },
        [](const Vec3&) { return Vec3(Vec3::Zero()); });
  };
  cover(0);
  blow(grid, {source});
  EXPECT_NEAR(grid.flowOut() / flowOf(source), 0.5, 0.01);
  EXPECT_LT(grid.largestOutflow(), 1e-3 * grid.fastest());
  cover(-0.4f);
  grid.reset();
  blow(grid, {source});
  EXPECT_EQ(grid.fastest(), 0);
}

TEST(SphereSource, HasNoPlaceToBlowToBetweenWallsOrBodies) {
  const Workers workers(1);
  const WindSource source = sphere(Vec3::Zero(), 0.15f, 3);
  Grid walls(simdPasses(), workers, 16, 0.1f, Grid::Border::kClosed);
  walls.centreAt(Vec3::Zero());
  blow(walls, {source}, 5);
  EXPECT_EQ(walls.fastest(), 0);
  Grid bodies(simdPasses(), workers, 16, 0.1f, Grid::Border::kOpen);
  bodies.centreAt(Vec3::Zero());
  enclose(bodies, false);
  blow(bodies, {source}, 5);
  EXPECT_EQ(bodies.fastest(), 0);
  enclose(bodies, true);
  blow(bodies, {source}, 5);
  EXPECT_NEAR(bodies.flowOut() / flowOf(source), 1, 5e-3) << "through the side that is open";
  EXPECT_LT(bodies.largestOutflow(), 1e-3 * bodies.fastest());
}

TEST(SphereSource, ThreadsAndLanesGiveTheSameWind) {
  auto run = [](const GridPasses<float>& passes, int threads) {
    const Workers workers(threads);
    Grid grid(passes, workers, 32, 0.025f, Grid::Border::kOpen);
    grid.centreAt(Vec3::Zero());
    blow(grid, {sphere(Vec3(0.01f, 0, 0), 0.1f, 3), sphere(Vec3(0.1f, 0.2f, 0), 0.01f, -50)}, 3);
    std::vector<double> out;
    for (int i = 0; i < 32; ++i)
      for (int axis = 0; axis < 3; ++axis)
        out.push_back(grid.component(axis, i, (7 * i) % 32, (11 * i) % 32));
    return out;
  };
  const std::vector<double> one = run(simdPasses(), 1);
  for (const int threads : {2, 7}) EXPECT_EQ(run(simdPasses(), threads), one) << threads;
  const std::vector<double> scalar = run(scalarPasses<float>(), 1);
  for (size_t i = 0; i < one.size(); ++i) EXPECT_NEAR(scalar[i], one[i], 5e-3);
}

TEST(SphereSource, WhatIsLeftIsOfWhatItWants) {
  const Workers workers(1);
  Grid grid(simdPasses(), workers, 16, 0.05f, Grid::Border::kOpen);
  grid.centreAt(Vec3::Zero());
  blow(grid, {sphere(Vec3::Zero(), 0.1f, 3)});
  EXPECT_LT(grid.largestOutflow(), 1e-3 * grid.fastest());
  const std::vector<WindSource> other{sphere(Vec3::Zero(), 0.1f, 6)};
  grid.setSources(other);
  EXPECT_GT(grid.largestOutflow(), 0.1 * grid.fastest()) << "not yet there";
}

}  // namespace
}  // namespace strandcast
