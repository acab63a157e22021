// Counts every operator new of the process while the CPU backends step.
#include <gtest/gtest.h>

#include <cmath>

#include "air/air_system.h"
#include "bench/counted_memory.h"
#include "collision/tree_broad_phase.h"
#include "core/body_set.h"
#include "core/simulation.h"
#include "simd/simd_backend.h"
#include "tests/conformance/conformance_model.h"

namespace strandcast {
namespace {

void expectNoAllocation(std::unique_ptr<Backend> backend) {
  const std::string device = backend->name() + " " + backend->device();
  RigidBody head{{{PrimitiveKind::kSphere, Vec3(0, -0.1f, 0), Vec3::UnitY(), 0.09f, 0.3f}}, true};
  Simulation simulation(awkwardModel(257, 91), {head}, Parameters(), std::move(backend));
  simulation.step();  // the first step starts worker threads
  const size_t before = allocations();
  for (int i = 0; i < 20; ++i) {
    simulation.setHeadPose({Vec3(0.001f * i, 0, 0), Quat::Identity()});
    simulation.step();
    ASSERT_EQ(simulation.guides().size(), simulation.model().vertices());
  }
  EXPECT_EQ(allocations() - before, 0u) << device;
}

TEST(StepAllocation, ManyBodiesThatMoveAllocateNothing) {
  Parameters parameters;
  parameters.solver = SolverKind::kRod;
  Simulation simulation(awkwardModel(65, 91), {}, parameters, makeReferenceBackend(), nullptr,
                        makeTreeBroadPhase());
  std::vector<BodyId> bodies;
  const auto place = [](size_t i, int step) {
    const float turn = 0.1f * static_cast<float>(i) + 0.2f * static_cast<float>(step);
    return Pose{Vec3(0.5f * std::cos(turn), 0.002f * static_cast<float>(i), 0.5f * std::sin(turn)),
                Quat::Identity()};
  };
  for (size_t i = 0; i < 100; ++i)
    bodies.push_back(
        simulation.addBody({{{PrimitiveKind::kCapsule, Vec3::Zero(), Vec3(0.1f, 0, 0), 0.05f, 0.3f}},
                            false,
                            false,
                            place(i, 0)}));
  simulation.step();
  const size_t before = allocations();
  for (int step = 1; step <= 10; ++step) {
    for (size_t i = 0; i < bodies.size(); ++i) simulation.setBodyPose(bodies[i], place(i, step));
    simulation.step();
  }
  EXPECT_EQ(allocations() - before, 0u);
}

TEST(StepAllocation, ABodySetAllocatesOnlyForABodyThatComes) {
  std::vector<Box> neighbourhoods(40, Box(Eigen::Vector3f::Constant(-1), Eigen::Vector3f::Constant(1)));
  BodySet bodies(makeAllPairs(), neighbourhoods.size());
  for (int i = 0; i < 30; ++i)
    bodies.add({{{PrimitiveKind::kSphere, Vec3::Zero(), Vec3::UnitY(), 0.05f, 0.3f}}});
  const size_t before = allocations();
  for (int step = 1; step <= 10; ++step) {
    for (BodyId body = 0; body < bodies.size(); ++body)
      bodies.setPose(body, {Vec3(0.001f * static_cast<float>(step), 0, 0), Quat::Identity()}, "test");
    bodies.place({}, {}, {}, 0.1f);
    EXPECT_EQ(bodies.findNear(neighbourhoods).bodies.size(), 40u * 30u);
    bodies.advance();
  }
  EXPECT_EQ(allocations() - before, 0u);
}

TEST(StepAllocation, WhatChangesWhileItRunsAllocatesBeforeTheStep) {
  std::vector<std::unique_ptr<Backend>> backends;
  backends.push_back(makeReferenceBackend());
  backends.push_back(makeSimdBackend(1));
  for (std::unique_ptr<Backend>& backend : backends) {
    Parameters changed;
    Simulation simulation(awkwardModel(65, 91), {}, changed, std::move(backend));
    simulation.step();
    const auto allocated = [&] {
      const size_t before = allocations();
      simulation.step();
      return allocations() - before;
    };
    simulation.addBody({{{PrimitiveKind::kSphere, Vec3::Zero(), Vec3::UnitY(), 0.05f, 0.3f}}});
    EXPECT_EQ(allocated(), 0u) << "a body";
    changed.goal_rate = 5;
    simulation.setParameters(changed);
    EXPECT_EQ(allocated(), 0u) << "a goal";
  }
}

TEST(StepAllocation, ABoneForEachRootAllocatesNothing) {
  std::vector<std::unique_ptr<Backend>> backends;
  backends.push_back(makeReferenceBackend());
  backends.push_back(makeSimdBackend(2));
  for (std::unique_ptr<Backend>& backend : backends) {
    StrandModel model = awkwardModel(257, 91);
    for (size_t s = 0; s < model.strands(); ++s) {
      model.bones.push_back("skin");
      model.root_bones.push_back(static_cast<uint16_t>(s + 1));
    }
    RigidBody ball{{{PrimitiveKind::kSphere, Vec3(0, -0.1f, 0), Vec3::UnitY(), 0.09f, 0.3f}}};
    Parameters parameters;
    parameters.solver = SolverKind::kRod;
    Simulation simulation(std::move(model), {ball}, parameters, std::move(backend), nullptr,
                          makeTreeBroadPhase());
    simulation.step();
    const size_t before = allocations();
    for (int i = 1; i <= 10; ++i) {
      for (size_t bone = 1; bone < simulation.model().bones.size(); ++bone)
        simulation.setBonePose(
            bone, {Vec3(0, 1e-5f * static_cast<float>(bone) * static_cast<float>(i), 0), Quat::Identity()});
      simulation.step();
    }
    EXPECT_EQ(allocations() - before, 0u) << simulation.backend().name();
  }
}

TEST(StepAllocation, TheCounterCounts) {
  const size_t before = allocations();
  auto number = std::make_unique<int>(3);
  EXPECT_EQ(*number, 3);
  EXPECT_GT(allocations(), before);
}

TEST(StepAllocation, WindAndForcesBetweenHairsAllocateNothing) {
  Parameters parameters;
  parameters.wind = Vec3(3, 0, 0);
  parameters.turbulence = 0.2f;
  parameters.wind_grid = parameters.mac_cormack = 1;
  parameters.grid_cells = 16;
  parameters.volume_stiffness = parameters.hair_friction = 1;
  parameters.air_drag_along = 0.5f;
  RigidBody head{{{PrimitiveKind::kSphere, Vec3(0, -0.1f, 0), Vec3::UnitY(), 0.09f, 0.3f}}, true};
  for (const int threads : {1, 2}) {
    Simulation simulation(awkwardModel(257, 91), {head}, parameters, makeSimdBackend(threads),
                          cpuAir("simd", threads).make({}));
    simulation.step();
    const size_t before = allocations();
    for (int i = 0; i < 20; ++i) {
      simulation.setHeadPose({Vec3(0.02f * static_cast<float>(i), 0, 0), Quat::Identity()});
      simulation.step();
    }
    EXPECT_EQ(allocations() - before, 0u) << threads;
  }
}

TEST(StepAllocation, AirThatIsOffAllocatesNothing) {
  auto allocationsOf = [](std::unique_ptr<ExternalForces> air_system) {
    std::unique_ptr<Backend> backend = makeSimdBackend(1);
    const StrandModel model = awkwardModel(257, 91);
    const size_t before = allocations();
    Simulation simulation(model, {}, Parameters(), std::move(backend), std::move(air_system));
    simulation.step();
    return allocations() - before;
  };
  allocationsOf(nullptr);  // the first step of a process starts threads
  EXPECT_EQ(allocationsOf(cpuAir("simd", 1).make({})), allocationsOf(nullptr));
}

TEST(StepAllocation, ReferenceAllocatesNothing) { expectNoAllocation(makeReferenceBackend()); }
TEST(StepAllocation, SimdAllocatesNothing) {
  for (const std::string& target : simdTargets())
    for (int threads : {1, 2, 0}) expectNoAllocation(makeSimdBackend(threads, target));
}

}  // namespace
}  // namespace strandcast
