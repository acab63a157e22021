#include "air/wind_grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "core/error.h"

namespace strandcast {
namespace {

using Grid = WindGrid<float>;

constexpr double kStep = 1.0 / 60;

Parameters windOf(const Vec3& wind) {
  Parameters parameters;
  parameters.wind = wind;
  return parameters;
}

MovingPrimitive ball(const Vec3& middle, float radius, const Vec3& motion = Vec3::Zero()) {
  ContactPrimitive primitive;
  primitive.a = middle;
  primitive.radius = radius;
  return moved(primitive, Pose{}, Pose{motion, Quat::Identity()}, static_cast<float>(kStep));
}

void blowPast(Grid& grid, const MovingPrimitive& body, int steps, bool mac_cormack = false) {
  for (int step = 0; step < steps; ++step) {
    grid.clearSolids();
    grid.addSolids({&body, 1}, {}, kStep);
    grid.advect(kStep, mac_cormack);
    grid.diffuse(kStep, 1e-3);
    grid.project();
  }
}

TEST(WindGrid, UniformWindStaysAsItIs) {
  const Workers workers(1);
  Grid grid(simdPasses(), workers, 32, 0.025f, Grid::Border::kOpen);
  const Vec3 wind(3, -1, 0.5f);
  grid.ambient().configure(windOf(wind));
  grid.centreAt(Vec3(0.1f, 1.6f, 0));
  grid.reset();
  for (int step = 0; step < 20; ++step) {
    grid.advect(kStep, step % 2 == 0);
    grid.diffuse(kStep, 1e-3);
    grid.project();
  }
  for (const Vec3& at : {Vec3(0.1f, 1.6f, 0), Vec3(-0.25f, 1.9f, 0.3f), Vec3(5, 5, 5)})
    EXPECT_LT((grid.velocityAt(at) - wind).norm(), 1e-4f);
}

// The two-dimensional vortex in a box of edge pi decays as exp(-2 viscosity t).
TEST(WindGrid, ATaylorGreenVortexConverges) {
  const Workers workers(1);
  for (const bool mac_cormack : {false, true}) {
    double errors[2] = {};
    for (const int doubled : {0, 1}) {
      const int cells = 16 << doubled;
      Grid grid(simdPasses(), workers, cells, static_cast<float>(M_PI) / static_cast<float>(cells),
                Grid::Border::kClosed);
      auto exact = [](const Vec3& x) {
        return Vec3(std::sin(x.x()) * std::cos(x.y()), -std::cos(x.x()) * std::sin(x.y()), 0);
      };
      grid.setVelocity(exact);
      for (int step = 0; step < cells; ++step) {
        grid.advect(1.0 / cells, mac_cormack);
        grid.diffuse(1.0 / cells, 0.05);
        grid.project();
      }
      for (int j = 0; j < cells; ++j)
        for (int i = 0; i < cells; ++i)
          errors[doubled] = std::max(errors[doubled],
                                     std::fabs(grid.component(0, i, j, 3) -
                                               std::exp(-0.1) * double{exact(grid.placeOf(0, i, j, 3)).x()}));
    }
    EXPECT_LT(errors[1], 0.05);
    EXPECT_GT(std::log2(errors[0] / errors[1]), 0.8);
  }
}

TEST(WindGrid, ProjectionLeavesNoDivergenceAtAnySize) {
  const Workers workers(1);
  for (const int cells : {16, 48, 64}) {
    Grid grid(simdPasses(), workers, cells, 0.8f / static_cast<float>(cells), Grid::Border::kOpen);
    grid.ambient().configure(windOf(Vec3(3, 0, 0)));
    grid.centreAt(Vec3::Zero());
    grid.reset();
    blowPast(grid, ball(Vec3::Zero(), 0.1f), 10);
    EXPECT_LT(grid.largestOutflow(), 1e-3 * grid.fastest()) << cells;
    const Vec3 lee = grid.velocityAt(Vec3(0.15f, 0, 0)), beside = grid.velocityAt(Vec3(0, 0.25f, 0));
    EXPECT_LT(lee.x(), 1.5f) << cells;
    EXPECT_GT(beside.x(), 2.8f) << cells;
  }
}

// Vectors and scalars differ by the rounding of sums only; results do not depend on the number of threads.
TEST(WindGrid, ThreadsAndLanesGiveTheSameWind) {
  auto run = [](const GridPasses<float>& passes, int threads) {
    const Workers workers(threads);
    Grid grid(passes, workers, 32, 0.025f, Grid::Border::kOpen);
    Parameters parameters = windOf(Vec3(2, 0, 1));
    parameters.turbulence = 0.3f;
    grid.ambient().configure(parameters);
    grid.centreAt(Vec3::Zero());
    grid.reset();
    blowPast(grid, ball(Vec3(0.01f, 0, 0), 0.09f), 4, true);
    std::vector<double> out;
    for (int i = 0; i < 32; ++i)
      for (int axis = 0; axis < 3; ++axis)
        out.push_back(grid.component(axis, i, (7 * i) % 32, (11 * i) % 32));
    return out;
  };
  const std::vector<double> one = run(simdPasses(), 1);
  for (const int threads : {2, 3, 7}) EXPECT_EQ(run(simdPasses(), threads), one) << threads;
  const std::vector<double> scalar = run(scalarPasses<float>(), 1);
  for (size_t i = 0; i < one.size(); ++i) EXPECT_NEAR(scalar[i], one[i], 5e-3);
}

TEST(WindGrid, DoubleAgreesWithFloat) {
  const Workers workers(1);
  WindGrid<double> exact(scalarPasses<double>(), workers, 16, 0.05f, WindGrid<double>::Border::kOpen);
  Grid grid(simdPasses(), workers, 16, 0.05f, Grid::Border::kOpen);
  const MovingPrimitive body = ball(Vec3::Zero(), 0.12f);
  auto run = [&](auto& any) {
    any.ambient().configure(windOf(Vec3(1, 0, 0)));
    any.centreAt(Vec3::Zero());
    any.reset();
    for (int step = 0; step < 5; ++step) {
      any.clearSolids();
      any.addSolids({&body, 1}, {}, kStep);
      any.advect(kStep, false);
      any.project();
    }
    return any.velocityAt(Vec3(0.2f, 0.05f, 0));
  };
  EXPECT_LT((run(exact) - run(grid)).norm(), 2e-3f);
}

TEST(WindGrid, AMovedGridKeepsTheAirWhereItIs) {
  const Workers workers(1);
  Grid grid(simdPasses(), workers, 32, 0.025f, Grid::Border::kOpen);
  grid.ambient().configure(windOf(Vec3(1, 0, 0)));
  grid.centreAt(Vec3::Zero());
  grid.reset();
  blowPast(grid, ball(Vec3::Zero(), 0.08f), 10);
  const Vec3 at(0.1f, 0.03f, -0.02f), before = grid.velocityAt(at);
  ASSERT_GT((before - Vec3(1, 0, 0)).norm(), 0.1f);
  grid.centreAt(Vec3(0.11f, 0.06f, -0.08f));
  EXPECT_LT((grid.velocityAt(at) - before).norm(), 1e-5f);
  EXPECT_LT((grid.velocityAt(Vec3(0.5f, 0.45f, -0.4f)) - Vec3(1, 0, 0)).norm(), 1e-5f) << "what came in";
  grid.centreAt(Vec3::Zero());
  EXPECT_LT((grid.velocityAt(at) - before).norm(), 1e-5f);
}

TEST(WindGrid, AMovingBodyDragsTheAirAlong) {
  const Workers workers(1);
  Grid grid(simdPasses(), workers, 32, 0.025f, Grid::Border::kOpen);
  grid.centreAt(Vec3::Zero());
  grid.reset();
  blowPast(grid, ball(Vec3(-0.02f, 0, 0), 0.1f, Vec3(0.02f, 0, 0)), 3);
  EXPECT_NEAR(grid.velocityAt(Vec3::Zero()).x(), 0.02 / kStep, 0.1) << "within";
  EXPECT_GT(grid.velocityAt(Vec3(0.15f, 0, 0)).x(), 0.2f) << "before it";
}

TEST(WindGrid, SignedDistancesOfAnyKindAreSolid) {
  const Workers workers(1);
  Grid grid(simdPasses(), workers, 16, 0.05f, Grid::Border::kOpen);
  grid.centreAt(Vec3::Zero());
  grid.clearSolids();
  grid.addSolid(
      Box(Eigen::Vector3f(-0.2f, -0.2f, -0.2f), Eigen::Vector3f(0.2f, 0.2f, 0.2f)),
      [](std::span<const Vec3> points, float* out) {
        for (const Vec3& x : points) *out++ = x.cwiseAbs().maxCoeff() - 0.2f;
      },
      [](const Vec3&) { return Vec3(Vec3::Zero()); });
  EXPECT_TRUE(grid.isSolid(8, 8, 8));
  EXPECT_TRUE(grid.isSolid(4, 4, 4));
  EXPECT_FALSE(grid.isSolid(3, 8, 8));
}

TEST(WindGrid, SourcesDriveTheAir) {
  const Workers workers(1);
  WindSource fan;
  fan.speed = 5;
  fan.length = 0.6f;
  fan.position = Vec3(0, 0, -0.3f);
  WindSource turbine;
  turbine.kind = WindSource::Kind::kTurbine;
  turbine.swirl = 4;
  turbine.speed = 0;
  for (const WindSource& source : {fan, turbine}) {
    Grid grid(simdPasses(), workers, 32, 0.025f, Grid::Border::kOpen);
    grid.centreAt(Vec3::Zero());
    grid.reset();
    grid.setSources({&source, 1});
    for (int step = 0; step < 60; ++step) {
      grid.advect(kStep, false);
      grid.exchange(kStep);
      grid.project();
    }
    if (source.kind == WindSource::Kind::kCone)
      EXPECT_GT(grid.velocityAt(Vec3(0, 0, -0.05f)).z(), 1.0f);
    else  // right-handed about z
      EXPECT_GT(grid.velocityAt(Vec3(0.1f, 0, 0)).y() - grid.velocityAt(Vec3(-0.1f, 0, 0)).y(), 1.0f);
  }
}

TEST(WindGrid, AThinTurbineBlowsWhereverItIsInACell) {
  const Workers workers(1);
  const float cell = 0.025f;
  float winds[2];
  for (int place : {0, 1}) {
    WindSource thin;
    thin.kind = WindSource::Kind::kTurbine;
    thin.position = Vec3(0, 0, (0.1f + 0.3f * static_cast<float>(place)) * cell);
    thin.length = 0.3f * cell;
    thin.rate = 100;
    Grid grid(simdPasses(), workers, 32, cell, Grid::Border::kOpen);
    grid.centreAt(Vec3::Zero());
    grid.reset();
    grid.setSources({&thin, 1});
    for (int step = 0; step < 60; ++step) {
      grid.advect(kStep, false);
      grid.exchange(kStep);
      grid.project();
    }
    winds[place] = grid.velocityAt(Vec3(0, 0, 0.05f)).z();
  }
  EXPECT_GT(winds[0], 0.5f);
  EXPECT_NEAR(winds[1], winds[0], 0.05f * winds[0]);
}

TEST(WindGrid, ASourceThatMovedAwayDrivesNothingAnyMore) {
  const Workers workers(1);
  Grid grid(simdPasses(), workers, 32, 0.025f, Grid::Border::kOpen);
  grid.centreAt(Vec3::Zero());
  grid.reset();
  for (const WindSource::Kind kind : {WindSource::Kind::kSphere, WindSource::Kind::kTurbine}) {
    WindSource source;
    source.kind = kind;
    source.radius = 0.1f;
    source.direction = Vec3::UnitX();
    for (const float y : {0.2f, -0.2f}) {
      source.position = Vec3(0, y, 0);
      grid.setSources({&source, 1});
      grid.reset();
      grid.exchange(kStep);
      if (kind == WindSource::Kind::kSphere) grid.project();
    }
    EXPECT_GT(grid.component(0, 18, 8, 16), 0.1) << "5 cm beside it";
    EXPECT_LT(grid.component(0, 18, 24, 16), 0.05) << "5 cm beside where it was";
  }
}

TEST(WindGrid, LanesAreAsFarFromABodyAsOnePointIs) {
  ContactPrimitive shape;
  shape.a = Vec3(0.01f, 0.02f, 0.03f);
  shape.b = Vec3(0.1f, 0, -0.05f);
  shape.radius = 0.05f;
  shape.radius_b = 0.02f;
  shape.extent = Vec3(0.05f, 0.03f, 0.08f);
  shape.rotation = Quat(Eigen::AngleAxisf(0.7f, Eigen::Vector3f(1, 2, 2).normalized()));
  std::vector<Vec3> points;
  for (int n = 0; n < 37; ++n)
    points.push_back(0.1f * Vec3(std::sin(1.3f * static_cast<float>(n)),
                                 std::cos(2.9f * static_cast<float>(n)), std::sin(static_cast<float>(n))));
  for (const PrimitiveKind kind :
       {PrimitiveKind::kSphere, PrimitiveKind::kCapsule, PrimitiveKind::kTaperedCapsule,
        PrimitiveKind::kEllipsoid, PrimitiveKind::kBox}) {
    shape.kind = kind;
    const MovingPrimitive body = moved(shape, Pose{}, Pose{Vec3(0.01f, 0, 0), Quat::Identity()}, 0.1f);
    for (const GridPasses<float>* passes : {&simdPasses(), &scalarPasses<float>()}) {
      std::vector<float> distances(points.size());
      passes->distances(body, nullptr, points.data()->data(), points.size(), distances.data());
      for (size_t n = 0; n < points.size(); ++n)
        EXPECT_NEAR(distances[n], signedDistance(body, points[n]), 1e-6f) << static_cast<int>(kind);
    }
  }
}

TEST(WindSource, IsCheckedAtTheDoor) {
  WindSource source;
  checkWindSource(source, "test");
  source.radius = 0;
  EXPECT_THROW(checkWindSource(source, "test"), Error);
  source = {};
  for (const float length : {0.0f, 1e30f, std::nanf("")}) {
    source.direction = Vec3(0, length, 0);
    EXPECT_THROW(checkWindSource(source, "test"), Error);
  }
  source = {};
  source.kind = static_cast<WindSource::Kind>(9);
  EXPECT_THROW(checkWindSource(source, "test"), Error);
  source = {};
  source.speed = std::nanf("");
  EXPECT_THROW(checkWindSource(source, "test"), Error);
  EXPECT_THROW(windSourceKind("storm", "test"), Error);
}

TEST(Ambient, TurbulenceHasItsStrengthAndItsSeed) {
  Parameters parameters = windOf(Vec3(4, 0, 0));
  parameters.turbulence = 0.25f;
  Ambient ambient, other;
  ambient.configure(parameters);
  double squares = 0;
  for (const Vec3& place : ambient.box()) squares += place.cast<double>().squaredNorm() / 3;
  EXPECT_NEAR(squares / static_cast<double>(ambient.box().size()), 1, 1e-3);
  squares = 0;
  int count = 0;
  for (float x = 0; x < 3; x += 0.07f)
    for (float y = 0; y < 3; y += 0.07f)
      for (float z = 0; z < 3; z += 0.07f, ++count)
        squares += (ambient.at(Vec3(x, y, z)) - ambient.mean()).squaredNorm() / 3;
  EXPECT_NEAR(std::sqrt(squares / count), 1, 0.05) << "a quarter of the wind";
  other.configure(parameters);
  EXPECT_EQ(other.at(Vec3(0.1f, 0.2f, 0.3f)), ambient.at(Vec3(0.1f, 0.2f, 0.3f)));
  parameters.wind_seed = 7;
  other.configure(parameters);
  EXPECT_NE(other.at(Vec3(0.1f, 0.2f, 0.3f)), ambient.at(Vec3(0.1f, 0.2f, 0.3f)));
}

TEST(Ambient, TurbulenceInWindAlongAnAxisIsNoSteadyWind) {
  for (const Vec3& wind : {Vec3(3, 0, 0), Vec3(0, 3, 0), Vec3(0, 0, 3)}) {
    Parameters parameters = windOf(wind);
    parameters.turbulence = 1;
    double steady = 0, all = 0;  // squares
    for (parameters.wind_seed = 1; parameters.wind_seed <= 3; ++parameters.wind_seed) {
      Ambient ambient;
      ambient.configure(parameters);
      constexpr int kTimes = 4000;
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (int i = 0; i < kTimes; ++i) {
        ambient.advance(0.0101);
        const Vec3 eddy = ambient.at(Vec3(0.1f, 0.2f, 0.3f)) - ambient.mean();
        sum += eddy.cast<double>() / kTimes;
        all += eddy.cast<double>().squaredNorm() / kTimes;
      }
      steady += sum.squaredNorm();
    }
    EXPECT_LT(steady, 0.02 * all) << wind.transpose();
  }
}

TEST(Ambient, GustsHaveTheirStrength) {
  Parameters parameters = windOf(Vec3(2, 0, 0));
  parameters.gust = 0.5f;
  parameters.gust_period = 4;
  Ambient ambient;
  ambient.configure(parameters);
  double sum = 0, squares = 0;
  constexpr int kTimes = 400;
  for (int i = 0; i < kTimes; ++i) {
    ambient.advance(4.0 / kTimes);
    const double speed = static_cast<double>(ambient.mean().x());
    sum += speed / kTimes;
    squares += (speed - 2) * (speed - 2) / kTimes;
  }
  EXPECT_NEAR(sum, 2, 1e-3);
  EXPECT_NEAR(std::sqrt(squares), 1, 1e-3);
}

TEST(Ambient, BlowsAfterADayAsAtTheStart) {
  Parameters parameters = windOf(Vec3(30, -2, 5));
  parameters.turbulence = 0.3f;
  Ambient ambient;
  ambient.configure(parameters);
  ambient.advance(86400.1);
  std::set<float> speeds;
  for (int i = 0; i < 200; ++i) speeds.insert(ambient.at(Vec3(5e-4f * static_cast<float>(i), 1.6f, 0)).y());
  EXPECT_GT(speeds.size(), 190u);
  EXPECT_EQ(ambient.at(Vec3::Constant(std::nanf(""))), ambient.mean());
  EXPECT_TRUE(ambient.at(Vec3::Constant(3e30f)).allFinite());
}

TEST(Ambient, OtherSettingsMoveNeitherEddiesNorGusts) {
  Parameters parameters = windOf(Vec3(3, 0, 0));
  parameters.turbulence = 0.3f;
  parameters.gust = 0.5f;
  Ambient ambient;
  ambient.configure(parameters);
  for (int hour = 0; hour < 4; ++hour) ambient.advance(3600 / 7.0);
  const Vec3 before = ambient.at(Vec3(0.05f, 0, 0));
  parameters.wind.x() = 3.01f;
  parameters.gust_period = 4.01f;
  ambient.configure(parameters);
  EXPECT_LT((ambient.at(Vec3(0.05f, 0, 0)) - before).norm(), 0.03f);
}

}  // namespace
}  // namespace strandcast
