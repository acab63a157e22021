// Effects of grooming on the reference backend. The conformance suite compares the other backends with it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>

#include "core/error.h"
#include "core/sag_free.h"
#include "core/simulation.h"
#include "validation/specimen.h"

namespace strandcast {
namespace {

constexpr int kEdges = 32;
constexpr double kGravity = 9.81;

Parameters parametersOf(SolverKind solver) {
  Parameters parameters;
  parameters.solver = solver;
  parameters.time_step = 1.0f / 360;
  parameters.substeps = 1;
  parameters.air_drag = 5;
  return parameters;
}

/// A strand of 20 cm from the origin along x, perpendicular to gravity.
Simulation level(const Parameters& parameters, const Material& material = {}, bool sag_free = false) {
  StrandModel model = modelOf({straightStrand(0.2, kEdges, Vec3::UnitX())}, material);
  if (sag_free) makeSagFree(model, parameters.gravity);
  return Simulation(std::move(model), {}, parameters, makeReferenceBackend());
}

void run(Simulation& simulation, double seconds) {
  const double step = simulation.parameters().time_step;
  for (int i = 0; i * step < seconds; ++i) simulation.step();
}

Material limp() {
  Material material;
  material.youngs_modulus = 1e4f;
  return material;
}

TEST(GoalPull, ALimpStrandSagsByGravityOverTheRateSquared) {
  for (const SolverKind solver : {SolverKind::kRod, SolverKind::kGaussSeidel}) {
    for (const float rate : {100.0f, 200.0f}) {
      Parameters parameters = parametersOf(solver);
      parameters.shape_rate = parameters.shape_rate_tip = 0;
      parameters.goal_rate = rate;
      Simulation simulation = level(parameters, limp());
      run(simulation, 4);
      const double exact = kGravity / (rate * rate);
      // Vertices far from the root, which does not sag.
      for (const int i : {kEdges / 2, kEdges})
        EXPECT_NEAR(-simulation.guides()[i].y(), exact, 0.02 * exact)
            << solverName(solver) << ", rate " << rate << ", vertex " << i;
    }
  }
}

TEST(GoalPull, AStrandAtItsGoalStays) {
  Parameters parameters = parametersOf(SolverKind::kRod);
  Simulation without = level(parameters, {}, true);
  parameters.goal_rate = 300;
  Simulation with = level(parameters, {}, true);
  run(without, 2);
  run(with, 2);
  const std::span<const Vec3> a = without.guides(), b = with.guides();
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_LT((b[i] - with.model().rest_roots[0].apply(with.model().rest_local[i])).norm(), 2e-6f);
    EXPECT_LT((a[i] - b[i]).norm(), 2e-6f);
  }
}

TEST(GoalPull, TheGoalGoesWithTheHead) {
  for (const float rate : {100.0f, 300.0f}) {
    Parameters parameters = parametersOf(SolverKind::kRod);
    parameters.gravity.setZero();
    parameters.goal_rate = rate;
    Simulation simulation = level(parameters, limp());
    const Pose there{Vec3(0, 0.1f, 0), Quat(Eigen::AngleAxisf(1.0f, Eigen::Vector3f::UnitZ()))};
    for (int i = 1; i <= 36; ++i) {
      simulation.setHeadPose(interpolate(Pose{}, there, static_cast<float>(i) / 36));
      simulation.step();
    }
    run(simulation, 4);
    for (int i = 0; i <= kEdges; ++i) {
      const Vec3 goal = there.apply(Vec3(0.2f * static_cast<float>(i) / kEdges, 0, 0));
      EXPECT_LT((simulation.guides()[i] - goal).norm(), 1e-4f) << "rate " << rate << ", vertex " << i;
    }
  }
}

TEST(GoalPull, FallsOffAlongTheStrand) {
  Parameters parameters = parametersOf(SolverKind::kRod);
  parameters.goal_rate = 200;
  Material material = limp();
  material.goal_scale.knots = {{0.5f, 1}, {0.55f, 0}};
  Simulation simulation = level(parameters, material);
  run(simulation, 4);
  EXPECT_GT(simulation.guides()[kEdges / 4].y(), -0.002f) << "the inner half is held";
  EXPECT_LT(simulation.guides()[kEdges].y(), -0.07f) << "the outer half hangs";
}

TEST(GoalPull, AFalloffOfNoPullChangesNothing) {
  for (const SolverKind solver : {SolverKind::kRod, SolverKind::kGaussSeidel}) {
    const Parameters parameters = parametersOf(solver);
    Material material;
    material.goal_scale.knots = {{0, 1}, {1, 0.25f}};  // scales goal_rate, which is 0
    Simulation plain = level(parameters);
    run(plain, 0.1);
    Simulation groomed = level(parameters, material);
    run(groomed, 0.1);
    for (size_t i = 0; i < plain.guides().size(); ++i)
      EXPECT_LT((groomed.guides()[i] - plain.guides()[i]).norm(), 1e-5f) << solverName(solver) << " " << i;
  }
}

TEST(MaterialFactors, DragOfAPartIsAFactorOfTheGlobalOne) {
  for (const SolverKind solver : {SolverKind::kRod, SolverKind::kGaussSeidel}) {
    Parameters parameters = parametersOf(solver);
    parameters.shape_rate = parameters.shape_rate_tip = 0;
    parameters.air_drag = 4;
    Parameters thrice = parameters;
    thrice.air_drag = 12;
    parameters.wind = thrice.wind = Vec3(0, 0, 2);
    Material draggy = limp();
    draggy.air_drag_scale.knots = {{0, 3}};
    Simulation scaled = level(parameters, draggy), direct = level(thrice, limp()),
               plain = level(parameters, limp());
    for (Simulation* s : {&scaled, &direct, &plain}) run(*s, 0.2);
    for (int i = 0; i <= kEdges; ++i)
      EXPECT_LT((scaled.guides()[i] - direct.guides()[i]).norm(), 1e-5f) << solverName(solver) << " " << i;
    EXPECT_GT((scaled.guides()[kEdges] - plain.guides()[kEdges]).norm(), 1e-2f);
  }
}

TEST(MaterialFactors, DampingOfAPartIsAFactorOfTheGlobalOne) {
  Parameters parameters = parametersOf(SolverKind::kRod);
  parameters.damping_time = 0.002f;
  Parameters thrice = parameters;
  thrice.damping_time = 0.006f;
  Material damped;
  damped.damping_scale = 3;
  Simulation scaled = level(parameters, damped), direct = level(thrice), plain = level(parameters);
  for (Simulation* s : {&scaled, &direct, &plain}) run(*s, 0.3);
  EXPECT_LT((scaled.guides()[kEdges] - direct.guides()[kEdges]).norm(), 1e-5f);
  EXPECT_GT((scaled.guides()[kEdges] - plain.guides()[kEdges]).norm(), 1e-4f);
}

TEST(MaterialFactors, FrictionOfAPartIsAFactorOfTheBodys) {
  // Distance, m, that wind drags the tip of a limp strand that falls on a floor.
  auto slides = [](SolverKind solver, float friction, float scale) {
    Parameters parameters = parametersOf(solver);
    parameters.shape_rate = parameters.shape_rate_tip = 0;
    parameters.wind = Vec3(0, 0, 2);
    const RigidBody floor{{{PrimitiveKind::kPlane, Vec3(0, -0.001f, 0), Vec3::UnitY(), 0, friction}}, false};
    Material material = limp();
    material.friction_scale = scale;
    Simulation simulation(modelOf({straightStrand(0.2, kEdges, Vec3::UnitX())}, material), {floor},
                          parameters, makeReferenceBackend());
    run(simulation, 0.1);
    return simulation.guides()[kEdges].z();
  };
  for (const SolverKind solver : {SolverKind::kRod, SolverKind::kGaussSeidel}) {
    EXPECT_NEAR(slides(solver, 0.8f, 0.25f), slides(solver, 0.2f, 1), 1e-5f) << solverName(solver);
    EXPECT_GT(slides(solver, 0.8f, 0.25f), slides(solver, 0.8f, 1) + 0.01f) << solverName(solver);
  }
}

TEST(MaterialFactors, AnEvenCurveIsTheFactorThatItIs) {
  Parameters parameters = parametersOf(SolverKind::kRod);
  parameters.damping_time = 0.002f;
  Material scaled, curved;
  scaled.damping_scale = 3;
  curved.damping_scale = 1.5f;
  curved.damping_curve.knots = {{0, 2}};
  Simulation by_scale = level(parameters, scaled), by_curve = level(parameters, curved);
  for (Simulation* s : {&by_scale, &by_curve}) run(*s, 0.3);
  EXPECT_EQ(stateHash(by_scale.state()), stateHash(by_curve.state()));
}

TEST(MaterialFactors, DampingOfTheInnerHalfIsMoreThanOfTheOuter) {
  // A level strand falls and swings without air drag. It bends most near its root, so damping there removes
  // most of the swing.
  Parameters parameters = parametersOf(SolverKind::kRod);
  parameters.air_drag = 0;
  parameters.damping_time = 0.1f;
  auto swing = [&](const RootTipCurve& curve) {
    Material material;
    material.damping_curve = curve;
    Simulation simulation = level(parameters, material);
    run(simulation, 2);
    float low = 0, high = -1;  // m, height of the tip
    for (int i = 0; i < 360; ++i) {
      simulation.step();
      low = std::min(low, simulation.guides()[kEdges].y());
      high = std::max(high, simulation.guides()[kEdges].y());
    }
    return high - low;
  };
  const float none = swing({{{0, 0}}}), all = swing({{{0, 1}}}), inner = swing({{{0.5f, 1}, {0.5f, 0}}}),
              outer = swing({{{0.5f, 0}, {0.5f, 1}}});
  std::printf("             the tip swings by %.4f m, damped %.4f, its inner half %.4f, its outer %.4f\n",
              static_cast<double>(none), static_cast<double>(all), static_cast<double>(inner),
              static_cast<double>(outer));
  EXPECT_LT(all, inner);
  EXPECT_LT(inner, 0.5f * outer);
  EXPECT_LT(all, 0.5f * none);
}

TEST(MaterialFactors, FrictionIsThatOfThePlaceAlongTheStrand) {
  // A limp strand lies on a floor in a cross wind. The half without friction is blown away.
  auto blown = [](SolverKind solver, const RootTipCurve& curve) {
    Parameters parameters = parametersOf(solver);
    parameters.shape_rate = parameters.shape_rate_tip = 0;
    parameters.wind = Vec3(0, 0, 2);
    const RigidBody floor{{{PrimitiveKind::kPlane, Vec3(0, -0.001f, 0), Vec3::UnitY(), 0, 1.5f}}, false};
    Material material = limp();
    material.friction_curve = curve;
    Simulation simulation(modelOf({straightStrand(0.2, kEdges, Vec3::UnitX())}, material), {floor},
                          parameters, makeReferenceBackend());
    run(simulation, 0.15);
    return std::pair(simulation.guides()[kEdges / 2].z(), simulation.guides()[kEdges].z());
  };
  for (const SolverKind solver : {SolverKind::kRod, SolverKind::kGaussSeidel}) {
    const auto everywhere = blown(solver, {{{0, 1}}}), inner = blown(solver, {{{0.5f, 1}, {0.5f, 0}}}),
               nowhere = blown(solver, {{{0, 0}}});
    EXPECT_GT(nowhere.second, everywhere.second + 0.01f) << solverName(solver);
    EXPECT_GT(inner.second, everywhere.second + 0.3f * (nowhere.second - everywhere.second))
        << solverName(solver) << ": its outer half goes";
    EXPECT_LT(inner.first, everywhere.first + 0.5f * (nowhere.first - everywhere.first))
        << solverName(solver) << ": its middle stays";
  }
}

TEST(Tethers, KeepLongHairFromStretching) {
  Parameters parameters = parametersOf(SolverKind::kGaussSeidel);
  parameters.shape_rate = parameters.shape_rate_tip = 0;
  parameters.time_step = 1.0f / 60;
  parameters.substeps = 2;
  auto longest = [&](float tether) {
    Material material;
    material.tether = tether;
    StrandModel model = modelOf({straightStrand(0.6, 100, Vec3::UnitX())}, material);
    Simulation simulation(std::move(model), {}, parameters, makeReferenceBackend());
    double most = 0;  // greatest ratio of distance from the root to arc length
    for (int step = 0; step < 180; ++step) {
      simulation.step();
      for (int i = 1; i <= 100; ++i)
        most = std::max<double>(most, simulation.guides()[i].norm() / (0.006 * i));
    }
    return most;
  };
  EXPECT_GT(longest(0), 1.5) << "without them it stretches";
  EXPECT_LT(longest(1), 1 + 1e-5);
  EXPECT_LT(longest(1.2f), 1.2 + 1e-5);
  EXPECT_GT(longest(1.2f), 1.19) << "they are no shorter than they are told to be";
}

StrandModel tiedModel() {
  StrandModel model =
      modelOf({straightStrand(0.2, kEdges, Vec3::UnitX()), straightStrand(0.2, kEdges, Vec3::UnitZ())});
  pinToBone(model, 0, 0.5f, 0.5f, "ribbon");
  pinToBone(model, 1, 0, 1, "clip");
  return model;
}

Simulation tied(const Parameters& parameters) {
  return Simulation(tiedModel(), {}, parameters, makeReferenceBackend());
}

TEST(Bones, TheHeadIsTheOnlyOneUnlessThereAreMore) {
  Simulation simulation = level(parametersOf(SolverKind::kRod));
  EXPECT_EQ(simulation.model().bones, std::vector<std::string>{"head"});
  EXPECT_EQ(tiedModel().bones, (std::vector<std::string>{"head", "ribbon", "clip"}));
}

TEST(Bones, WhatIsPinnedToABoneGoesWithItAndNothingElse) {
  for (const SolverKind solver : {SolverKind::kRod, SolverKind::kGaussSeidel}) {
    Simulation simulation = tied(parametersOf(solver));
    const StrandModel& model = simulation.model();
    const Pose ribbon{Vec3(-0.02f, 0.03f, 0.01f), Quat(Eigen::AngleAxisf(0.3f, Eigen::Vector3f::UnitY()))};
    const Pose clip{Vec3(0, 0.05f, 0), Quat(Eigen::AngleAxisf(0.5f, Eigen::Vector3f::UnitX()))};
    for (int i = 1; i <= 72; ++i) {
      simulation.setBonePose("ribbon", interpolate(Pose{}, ribbon, static_cast<float>(i) / 72));
      simulation.setBonePose(2, interpolate(Pose{}, clip, static_cast<float>(i) / 72));
      simulation.step();
    }
    const std::span<const Vec3> now = simulation.guides();
    const uint32_t middle = kEdges / 2, second = model.offsets[1];
    EXPECT_LT(now[0].norm(), 1e-6f) << "the root of the first strand is the head's";
    EXPECT_LT((now[middle] - ribbon.apply(model.restPosition(0, middle))).norm(), 1e-6f)
        << solverName(solver);
    for (uint32_t v = second; v < model.offsets[2]; ++v)
      EXPECT_LT((now[v] - clip.apply(model.restPosition(1, v))).norm(), 2e-6f)
          << solverName(solver) << " " << v;
    EXPECT_EQ(simulation.resetDiverged(), 0u);
    EXPECT_LT((simulation.bonePose(2).position - clip.position).norm(), 1e-6f);
    EXPECT_LT(simulation.measure().max_stretch, solver == SolverKind::kRod ? 1e-3 : 0.1);
  }
}

TEST(Bones, ATieMovesSmoothlyWithinAStep) {
  Parameters parameters = parametersOf(SolverKind::kRod);
  parameters.time_step = 1.0f / 60;
  parameters.substeps = 8;
  Simulation simulation = tied(parameters);
  const Vec3 way(0, 0.008f, 0);
  simulation.setBonePose("ribbon", {way, Quat::Identity()});
  simulation.step();
  const Vec3 velocity = simulation.state().velocities[kEdges / 2];
  EXPECT_LT((velocity - way * 60).norm(), 1e-3f) << "the velocity of its last substep is that of the step";
}

TEST(Bones, ResetAndTeleportTakeThemAlong) {
  Simulation simulation = tied(parametersOf(SolverKind::kRod));
  const Pose ribbon{Vec3(-0.01f, 0.02f, 0), Quat::Identity()};
  const Pose there{Vec3(1, 2, 3), Quat(Eigen::AngleAxisf(1.0f, Eigen::Vector3f::UnitY()))};
  const uint32_t middle = kEdges / 2;
  simulation.setBonePose("ribbon", ribbon);
  simulation.step();
  simulation.reset();
  const Vec3 rest = simulation.model().restPosition(0, middle);
  EXPECT_LT((simulation.guides()[middle] - ribbon.apply(rest)).norm(), 1e-6f);
  simulation.teleport(there);
  EXPECT_LT((simulation.guides()[middle] - (there * ribbon).apply(rest)).norm(), 1e-5f);
  simulation.step();
  EXPECT_LT((simulation.guides()[middle] - (there * ribbon).apply(rest)).norm(), 1e-5f);
}

TEST(Bones, ACutTakesThemAlong) {
  Simulation simulation = tied(parametersOf(SolverKind::kRod));
  for (int i = 0; i < 20; ++i) simulation.step();
  const StrandState before = simulation.state();
  const StrandModel& model = simulation.model();
  const Pose there{Vec3(1, 2, 3), Quat(Eigen::AngleAxisf(1.0f, Eigen::Vector3f::UnitY()))};
  const Pose clip{Vec3(0, 0, -2), Quat::Identity()};
  simulation.setHeadPose(there);
  simulation.setBonePose("ribbon", there * Pose{Vec3(0, 0.001f, 0), Quat::Identity()});
  simulation.setBonePose("clip", clip);
  simulation.jumpToPoses();
  const StrandState after = simulation.state();
  const uint32_t middle = kEdges / 2;
  for (uint32_t v = 0; v < model.vertices(); ++v) {
    const Pose motion = simulation.bonePose(v >= model.offsets[1] ? 2 : v >= middle ? 1 : 0);
    EXPECT_LT((after.positions[v] - motion.apply(before.positions[v])).norm(), 1e-6f) << v;
  }
  simulation.step();
  EXPECT_EQ(simulation.resetDiverged(), 0u);
  EXPECT_LT((simulation.guides()[middle] - after.positions[middle]).norm(), 1e-6f) << "the tie stands still";
}

TEST(Bones, WhatIsNoBoneOrNoRangeIsRefused) {
  auto refusal = [](const std::function<void()>& call) -> std::string {
    try {
      call();
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  Simulation simulation = tied(parametersOf(SolverKind::kRod));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_NE(refusal([&] { simulation.setBonePose("ribon", Pose{}); }).find("did you mean 'ribbon'"),
            std::string::npos);
  EXPECT_NE(refusal([&] { simulation.setBonePose(3, Pose{}); }).find("the model has 3"), std::string::npos);
  EXPECT_NE(refusal([&] {
              simulation.setBonePose(1, {Vec3(0, nan, 0), Quat::Identity()});
            }).find("Simulation::setBonePose"),
            std::string::npos);
  for (const auto& [from, to] : {std::pair(0.5f, 0.4f), std::pair(-0.1f, 0.5f), std::pair(0.5f, 1.1f),
                                 std::pair(nan, 1.0f), std::pair(0.51f, 0.52f)}) {
    const std::string error = refusal([&, a = from, b = to] {
      StrandModel model = tiedModel();
      pinToBone(model, 0, a, b, "pin");
    });
    EXPECT_NE(error.find("bone 'pin', strand 0"), std::string::npos) << from << " to " << to << ": " << error;
  }
}

}  // namespace
}  // namespace strandcast
