#include "light/traced_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "tests/expect_error.h"

namespace strandcast {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

void addTracedHair(TracedHair& hair, const std::vector<Vec3>& points, float radius, float tip_radius) {
  for (size_t i = 0; i < points.size(); ++i) {
    hair.positions.push_back(points[i]);
    const Vec3 along = points[std::min(i + 1, points.size() - 1)] - points[i > 0 ? i - 1 : 0];
    hair.tangents.push_back(along.normalized());
    const float part = static_cast<float>(i) / static_cast<float>(points.size() - 1);
    hair.radii.push_back(radius + part * (tip_radius - radius));
  }
  hair.offsets.push_back(static_cast<uint32_t>(hair.positions.size()));
  hair.absorption.push_back({Vec3(Vec3::Zero()), Vec3(Vec3::Zero())});
}

/// Straight vertical hairs on a grid of `side` x `side`, `spacing` metres apart, from `top` to the ground at
/// 0.
TracedHair hangingHair(int side, float spacing, float top, int segments, float radius, float tip_radius) {
  TracedHair hair;
  for (int i = 0; i < side * side; ++i) {
    std::vector<Vec3> points;
    for (int k = 0; k <= segments; ++k)
      points.emplace_back(static_cast<float>(i % side) * spacing,
                          top * (1 - static_cast<float>(k) / static_cast<float>(segments)),
                          static_cast<float>(i / side) * spacing);
    addTracedHair(hair, points, radius, tip_radius);
  }
  return hair;
}

TracedHair oneHair(const std::vector<Vec3>& points, float radius) {
  TracedHair hair;
  addTracedHair(hair, points, radius, radius);
  return hair;
}

TEST(TracedScene, HairUnderASunAtTheZenithHasTheShadowOfASlightlyTiltedOne) {
  constexpr int kSide = 10;
  constexpr float kSpacing = 0.004f, kRadius = 0.001f;
  for (const float tip : {kRadius, 0.9f * kRadius})
    for (const int segments : {10, 31}) {
      const TracedScene scene(hangingHair(kSide, kSpacing, 0.1f, segments, kRadius, tip), {});
      std::mt19937 engine(1);
      std::uniform_real_distribution<double> uniform(-0.5, kSide - 0.5);
      constexpr int kPoints = 20000;
      int shaded[3] = {};
      for (int i = 0; i < kPoints; ++i) {
        const Eigen::Vector3d point =
            Eigen::Vector3d(kSpacing * uniform(engine), -0.01, kSpacing * uniform(engine)) - scene.origin();
        const double slopes[3] = {0, 1e-6, 1e-4};
        for (int k = 0; k < 3; ++k)
          shaded[k] += scene.isBlocked(point, Eigen::Vector3d(slopes[k], 1, 0).normalized(), kFar);
      }
      const double wanted = kPoints * std::numbers::pi * kRadius * kRadius / (kSpacing * kSpacing);
      for (const int count : shaded) EXPECT_NEAR(count, wanted, 0.035 * wanted);
      EXPECT_NEAR(shaded[0], shaded[1], 0.002 * wanted);
      EXPECT_NEAR(shaded[0], shaded[2], 0.01 * wanted);
    }
}

TEST(TracedScene, HitsLieOnTheHairAtAnyDistanceFromTheStart) {
  const float radius = 4e-5f;
  const TracedScene scene(oneHair({Vec3(1, 2, 3), Vec3(1.01f, 2, 3), Vec3(1.02f, 2.001f, 3)}, radius), {});
  for (const double away : {0.05, 0.5, 1.5, 2.5, 1000.0, 25000.0})
    for (const double off : {-0.9, -0.3, 0.0, 0.5, 0.99}) {
      const double r = static_cast<double>(radius), up = std::sqrt(1 - off * off) * r;
      const Eigen::Vector3d axis(1.004, 2, 3);
      const Eigen::Vector3d start = axis - scene.origin() + Eigen::Vector3d(0, up + away * r, off * r);
      const TracedHit hit = scene.hit(start, -Eigen::Vector3d::UnitY());
      ASSERT_EQ(hit.kind, TracedHit::Kind::kHair) << away << " " << off;
      EXPECT_NEAR(hit.distance, away * r, 0.006 * r);
      EXPECT_NEAR((hit.position - hit.center).norm(), r, 1e-3 * r);
      EXPECT_NEAR(hit.along, 0.2, 1e-3);
      EXPECT_GT(hit.tangent.x(), 0.99);
    }
}

TEST(TracedScene, ARayDoesNotMeetTheSegmentThatItLeavesNorOneThatItStartsIn) {
  const float radius = 0.01f;
  const TracedScene scene(oneHair({Vec3(0, 0, 0), Vec3(0.2f, 0, 0)}, radius), {});
  const TracedHit hit = scene.hit(Eigen::Vector3d(0, 1, 0), -Eigen::Vector3d::UnitY());
  ASSERT_EQ(hit.kind, TracedHit::Kind::kHair);
  for (const Eigen::Vector3d& direction :
       {Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0, -1, 0), Eigen::Vector3d(1, 0, 0),
        Eigen::Vector3d(0.9, 0.3, 0.4), Eigen::Vector3d(-0.2, -0.7, 0.1)}) {
    const Eigen::Vector3d unit = direction.normalized(), start = scene.departure(hit, unit);
    EXPECT_EQ(scene.hit(start, unit, &hit).kind, TracedHit::Kind::kNothing);
    EXPECT_FALSE(scene.isBlocked(start, unit, kFar, &hit));
  }
  EXPECT_EQ(scene.hit(Eigen::Vector3d(0, 0.001, 0), Eigen::Vector3d::UnitY()).kind,
            TracedHit::Kind::kNothing);
}

TEST(TracedScene, SurfacesAreMetFromBothSidesAndHideHairBehind) {
  TracedMesh floor;
  floor.mesh.positions = {Vec3(-1, 0, -1), Vec3(1, 0, -1), Vec3(0, 0, 1)};
  floor.mesh.triangles = {{0, 2, 1}, {0, 1, 7}};  // the second is left out
  const TracedScene scene(oneHair({Vec3(-0.1f, -0.1f, 0), Vec3(0.1f, -0.1f, 0)}, 0.001f), {floor});
  for (const double side : {1.0, -1.0}) {
    const Eigen::Vector3d start = Eigen::Vector3d(0, side, 0.01) - scene.origin();
    const TracedHit hit = scene.hit(start, -side * Eigen::Vector3d::UnitY());
    ASSERT_EQ(hit.kind, TracedHit::Kind::kSurface);
    EXPECT_NEAR(hit.distance, 1, 1e-6);
    EXPECT_NEAR(hit.normal.y(), side, 1e-6);
  }
  const Eigen::Vector3d above = Eigen::Vector3d(0, 0.5, 0) - scene.origin();
  EXPECT_EQ(scene.hit(above, -Eigen::Vector3d::UnitY()).kind, TracedHit::Kind::kSurface);
  const Eigen::Vector3d below = Eigen::Vector3d(0, -0.05, 0) - scene.origin();
  EXPECT_EQ(scene.hit(below, -Eigen::Vector3d::UnitY()).kind, TracedHit::Kind::kHair);
}

TEST(TracedScene, RefusesHairThatCannotBeTraced) {
  const auto refused = [](auto change, const char* words) {
    TracedHair hair = oneHair({Vec3(0, 0, 0), Vec3(0.1f, 0, 0)}, 1e-4f);
    change(hair);
    expectError([&] { TracedScene(std::move(hair), {}); }, {words});
  };
  refused([](TracedHair& h) { h.radii[1] = 0; }, "radius of a hair is 0 m");
  refused([](TracedHair& h) { h.radii[0] = std::nanf(""); }, "radius of a hair is nan m");
  refused([](TracedHair& h) { h.absorption[0][1].y() = -1; }, "absorption of a hair is -1");
  refused([](TracedHair& h) { h.absorption[0][0].x() = std::nanf(""); }, "absorption of a hair is nan");
  refused([](TracedHair& h) { h.positions[0].x() = std::numeric_limits<float>::infinity(); }, "not finite");
  refused([](TracedHair& h) { h.tangents.pop_back(); }, "do not fit together");
}

}  // namespace
}  // namespace strandcast
