#include "core/hair_pull.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/error.h"
#include "core/simulation.h"

namespace strandcast {
namespace {

/// Two strands of 11 vertices that hang 10 cm down, from the origin and from 5 cm beside it.
StrandModel twoStrands() {
  StrandSet set;
  for (const float x : {0.0f, 0.05f}) {
    std::vector<Vec3> points;
    for (int i = 0; i <= 10; ++i) points.emplace_back(x, -0.01f * static_cast<float>(i), 0);
    set.append(points);
  }
  return makeStrandModel(set);
}

Simulation hanging(SolverKind solver) {
  Parameters parameters;
  parameters.solver = solver;
  return Simulation(twoStrands(), {}, parameters, makeReferenceBackend());
}

TEST(HairPull, HoldsWhatIsWithinItsRadiusAndAtLeastTheNearestFreeVertex) {
  const StrandModel model = twoStrands();
  std::vector<Vec3> positions;
  for (size_t s = 0; s < 2; ++s)
    for (uint32_t v = model.offsets[s]; v < model.offsets[s + 1]; ++v)
      positions.push_back(model.restPosition(s, v));
  EXPECT_EQ(HairPull(model, positions, Vec3(0, -0.1f, 0), 0.021f).vertices(), 3u);
  EXPECT_EQ(HairPull(model, positions, Vec3(0.3f, -0.1f, 0), 0.01f).vertices(), 1u);
  EXPECT_EQ(HairPull(model, positions, Vec3::Zero(), 0).vertices(), 1u) << "the root is pinned";
}

TEST(HairPull, AFreeVertexComesToTheHandAtAnyRateAndStays) {
  const StrandModel model = twoStrands();
  for (const float rate : {5.0f, 100.0f, 1000.0f}) {
    std::vector<Vec3> x(model.vertices(), Vec3::Zero()), v(model.vertices(), Vec3::Zero());
    HairPull pull(model, x, Vec3::Zero(), 0);
    pull.moveTo(Vec3(0.1f, 0, 0), rate);
    constexpr float kStep = 1.0f / 60;
    float farthest = 0;
    for (int i = 0; i < 300; ++i) {
      const std::span<const Vec3> a = pull.accelerations({}, x, v, kStep);
      for (size_t n = 0; n < x.size(); ++n) {
        v[n] += kStep * a[n];
        x[n] += kStep * v[n];
        farthest = std::max(farthest, x[n].x());
      }
    }
    EXPECT_NEAR(farthest, 0.1f, 1e-4f) << rate << ": no overshoot";
    EXPECT_NEAR(
        std::max_element(x.begin(), x.end(), [](const Vec3& a, const Vec3& b) { return a.x() < b.x(); })->x(),
        0.1f, 1e-4f)
        << rate;
  }
}

TEST(HairPull, AddsToOtherAccelerationsOfEveryStepAlone) {
  const StrandModel model = twoStrands();
  const std::vector<Vec3> x(model.vertices(), Vec3::Zero()), v = x, others(model.vertices(), Vec3(1, 2, 4));
  HairPull pull(model, x, Vec3::Zero(), 0);
  for (const float way : {0.25f, 0.5f}) {
    pull.moveTo(Vec3(0, way, 0), 1);
    const std::span<const Vec3> own = pull.accelerations({}, x, v, 1);
    const std::vector<Vec3> alone(own.begin(), own.end());
    const std::span<const Vec3> both = pull.accelerations(others, x, v, 1);
    ASSERT_EQ(alone.size(), model.vertices());
    ASSERT_EQ(both.size(), model.vertices());
    for (size_t s = 0; s < 2; ++s)
      for (uint32_t i = model.offsets[s]; i < model.offsets[s + 1]; ++i) {
        // x' = dt v' = dt^2 a and a = way - x' - 2 v', thus a = way / 4.
        const Vec3 held = model.isPinned(s, i) ? Vec3(Vec3::Zero()) : Vec3(0, way / 4, 0);
        EXPECT_EQ(alone[i], held) << i;
        EXPECT_EQ(both[i], Vec3(others[i] + held)) << i;
      }
  }
}

TEST(HairPull, TheTipFollowsTheHandAndTheOtherStrandDoesNot) {
  for (const SolverKind solver : {SolverKind::kRod, SolverKind::kGaussSeidel}) {
    Simulation simulation = hanging(solver), alone = hanging(solver);
    simulation.pullHair(Vec3(0, -0.1f, 0), 0.015f, Vec3(-0.06f, -0.05f, 0), 100);
    EXPECT_EQ(simulation.pulledVertices(), 2u);
    for (int i = 0; i < 120; ++i) {
      simulation.step();
      alone.step();
    }
    const Vec3 hand(-0.06f, -0.05f, 0);
    EXPECT_LT((simulation.guides()[10] - hand).norm(), 0.5f * (alone.guides()[10] - hand).norm())
        << solverName(solver) << ": as far as the hair's stiffness lets it";
    for (size_t v = 11; v < 22; ++v)
      EXPECT_EQ(simulation.guides()[v], alone.guides()[v]) << solverName(solver);
    simulation.releaseHair();
    for (int i = 0; i < 600; ++i) simulation.step();
    EXPECT_LT((simulation.guides()[10] - alone.guides()[10]).norm(), 0.02f) << solverName(solver);
  }
}

TEST(HairPull, TheSamePlaceMovesTheHandAndAnotherClosesItAnew) {
  Simulation simulation = hanging(SolverKind::kRod);
  const Vec3 from(0, -0.1f, 0);
  simulation.pullHair(from, 0.015f, from, 50);
  for (int i = 0; i < 30; ++i) simulation.step();
  simulation.pullHair(from, 0.015f, Vec3(-0.05f, -0.08f, 0), 50);
  for (int i = 0; i < 60; ++i) simulation.step();
  EXPECT_EQ(simulation.pulledVertices(), 2u) << "those of the first time, though they have moved away";
  simulation.pullHair(Vec3(0.05f, -0.1f, 0), 0.005f, from, 50);
  EXPECT_EQ(simulation.pulledVertices(), 1u);
}

TEST(HairPull, WhatIsNotSoundIsRefused) {
  Simulation simulation = hanging(SolverKind::kRod);
  const Vec3 nowhere(std::numeric_limits<float>::quiet_NaN(), 0, 0);
  EXPECT_THROW(simulation.pullHair(nowhere, 0.1f, Vec3::Zero(), 10), Error);
  EXPECT_THROW(simulation.pullHair(Vec3::Zero(), -1, Vec3::Zero(), 10), Error);
  EXPECT_THROW(simulation.pullHair(Vec3::Zero(), 0.1f, nowhere, 10), Error);
  EXPECT_THROW(simulation.pullHair(Vec3::Zero(), 0.1f, Vec3::Zero(), 1e9f), Error);
  EXPECT_THROW(simulation.pullHair(Vec3::Zero(), 0.1f, Vec3(0, 2 * kMaxHandCoordinate, 0), 10), Error);
  EXPECT_EQ(simulation.pulledVertices(), 0u);
}

TEST(HairPull, AHandAsFarAndAsHardAsItMayBreaksNothing) {
  Simulation simulation = hanging(SolverKind::kRod);
  simulation.pullHair(Vec3::Zero(), 10, Vec3::Constant(kMaxHandCoordinate), 1000);
  for (int i = 0; i < 60; ++i) {
    simulation.step();
    EXPECT_EQ(simulation.resetDiverged(), 0u) << i;
  }
}

}  // namespace
}  // namespace strandcast
