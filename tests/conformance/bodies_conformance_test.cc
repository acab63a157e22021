// Every backend and solver among bodies: one step against the oracle, and invariants of many steps.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <random>

#include "core/measure.h"
#include "core/simulation.h"
#include "tests/conformance/conformance_fixture.h"
#include "tests/conformance/conformance_model.h"
#include "tests/thorough.h"

namespace strandcast {
namespace {

// Input of a step among bodies and the oracle's result, shared by all backends.
struct StepAmongBodies {
  StrandModel model;
  StrandState from, truth;
  Parameters parameters;
  ShapeData shapes;
  std::vector<MovingPrimitive> bodies;
  std::vector<Pose> bones_end;
  std::vector<double> sensitivity, touched;  // touched: displacement of a strand by the bodies

  StepInput input() const { return {&parameters, {}, bones_end, bodies, {}, &shapes}; }
  double substep() const { return parameters.time_step / parameters.substeps; }
  void computeOracle() {
    model.rest_distance = restDistancesAtStart(from, bodies, shapes.words);
    truth = oracleStep(model, from, input());
    sensitivity = sensitivities(model, from, truth, input(), substep());
    touched = errors(model, truth, oracleStep(model, from, {&parameters, {}, bones_end}), substep());
  }
};
std::vector<StepAmongBodies> stepsAmongBodies(const Parameters& common) {
  std::vector<StepAmongBodies> out;
  for (uint32_t seed = 1; seed <= 8; ++seed)
    for (const StepCase& c : kStepCases) {
      if (!c.bodies) continue;
      StepAmongBodies step;
      step.model = c.groomed ? awkwardModel(257, 11, groomedMaterials()) : awkwardModel(257, 11);
      step.from = disturbedState(step.model, seed);
      step.bodies = movingBodies(common.time_step);
      if (c.moving_roots) step.bones_end = {movedHead()};
      step.parameters = parametersOf(c, common);
      step.computeOracle();
      out.push_back(std::move(step));
    }
  return out;
}

// Rounding may decide whether a strand of the rod that is thrown at a body touches it. A few nudges of the
// oracle's input do not predict that. This counts such strands over randomly drawn states.
struct Disagreement {
  size_t compared = 0, off = 0, far = 0;
  void add(const StepAmongBodies& step, const std::vector<double>& error) {
    for (size_t s = 0; s < error.size(); ++s) {
      if (tooDense(step.model, s, step.substep(), kDensestAmongBodies)) continue;
      ++compared;
      off += error[s] >= kAmongBodiesTolerance + kSensitivityFactor * step.sensitivity[s];
      if (error[s] < kGrazingTolerance) continue;
      ++far;
      std::printf("             strand %zu, stiffness %.0f, is off by %.1e\n", s,
                  stiffnessOf(step.model, s, step.substep()), error[s]);
    }
  }
  void expectLittle(double max_off_share) const {
    std::printf("             of %zu strands %zu are off, %zu of them far\n", compared, off, far);
    EXPECT_LT(static_cast<double>(off), max_off_share * static_cast<double>(compared));
    EXPECT_LT(static_cast<double>(far), kMaxFarShare * static_cast<double>(compared));
  }
};

TEST_P(Conformance, NearlyAllStrandsAmongBodiesAgreeWithTheOracle) {
  if (parameters_.solver != SolverKind::kRod) return;
  if (kSanitized) GTEST_SKIP() << "it counts strands; OneStepWithEveryKindOfBody runs the same code";
  if (backend_->name() == "gpu" && !thorough()) GTEST_SKIP() << kSkippedUnlessThorough;
  static const std::vector<StepAmongBodies> steps = stepsAmongBodies(parameters_);
  Disagreement all;
  for (const StepAmongBodies& step : steps)
    all.add(step,
            errors(step.model, stepped(step.model, step.from, step.input()), step.truth, step.substep()));
  all.expectLittle(maxOffShare());
}

// Bodies of every kind, each alone, so that a difference is attributable to one kind. The rod starts from
// several states, because its strands are counted. Under a sanitizer one state covers all of the code.
using StepsOfKind = std::vector<StepAmongBodies>;
std::vector<StepsOfKind> stepsOfEachKind(const Parameters& common) {
  std::vector<StepsOfKind> out(kFurtherKinds);
  const uint32_t states = common.solver == SolverKind::kRod && !kSanitized ? 8 : 1;
  for (int kind = 0; kind < kFurtherKinds; ++kind)
    for (uint32_t state = 0; state < states; ++state) {
      StepAmongBodies& step = out[static_cast<size_t>(kind)].emplace_back();
      step.model = awkwardModel(65, 17);
      step.from = disturbedState(step.model, 18 + state);
      step.parameters = common;
      step.bodies = {furtherBody(kind, common.time_step, step.shapes)};
      step.bones_end = {movedHead()};
      step.computeOracle();
    }
  return out;
}
TEST_P(Conformance, OneStepWithEveryKindOfBodyAgreesWithTheOracle) {
  static std::map<SolverKind, std::vector<StepsOfKind>> known;
  std::vector<StepsOfKind>& kinds = known[parameters_.solver];
  if (kinds.empty()) kinds = stepsOfEachKind(parameters_);
  const bool rod = parameters_.solver == SolverKind::kRod;
  Disagreement all;
  for (const StepsOfKind& steps : kinds) {
    const auto kind = &steps - kinds.data();
    size_t strands = 0, moved_by_body = 0;
    double worst = 0;
    for (const StepAmongBodies& step : steps) {
      const std::vector<double> error =
          errors(step.model, stepped(step.model, step.from, step.input()), step.truth, step.substep());
      strands += step.model.strands();
      for (size_t s = 0; s < error.size(); ++s) {
        if (rod && tooDense(step.model, s, step.substep())) continue;
        moved_by_body += step.touched[s] > 1e-3;
        worst = std::max(worst, error[s]);
        if (!rod) {
          EXPECT_LT(error[s], kOneStepTolerance + kSensitivityFactor * step.sensitivity[s])
              << "strand " << s << ", kind " << kind;
        }
      }
      if (rod) all.add(step, error);
    }
    std::printf("             kind %td moves %zu strands of %zu: %.1e of a strand's length\n", kind,
                moved_by_body, strands, worst);
    EXPECT_GT(moved_by_body, strands / 8);
  }
  // Under a sanitizer there is one state only, and the permitted share is less than one strand.
  if (rod && !kSanitized) all.expectLittle(maxOffShare());
}

// Hair stands up from a floor. A ball that covers some of its roots rises by 1 mm per step.
TEST_P(Conformance, HairNearRootsThatABodyCoversAgreesWithTheOracle) {
  constexpr float kBall = 0.04f;  // m
  constexpr int kSide = 8, kRising = 30;
  StrandSet set;
  for (int s = 0; s < kSide * kSide; ++s) {
    const Vec3 root(0.01f * static_cast<float>(s % kSide - kSide / 2) + 1e-3f, 0,
                    0.01f * static_cast<float>(s / kSide - kSide / 2) + 2e-3f);
    const int vertices = s % 3 == 0 ? 9 : 17;
    std::vector<Vec3> points;
    for (int i = 0; i < vertices; ++i)
      points.push_back(root + Vec3(0.02f, 0.12f, 0.01f) *
                                  (static_cast<float>(i) / static_cast<float>(vertices - 1)));
    set.append(points);
  }
  const StrandModel model = makeStrandModel(set);
  const ContactPrimitive ball{PrimitiveKind::kSphere, Vec3::Zero(), Vec3::UnitY(), kBall, 0.3f};
  auto bodiesAt = [&](int step) {
    const auto pose = [](int at) {
      return Pose{Vec3(0, 1e-3f * static_cast<float>(at - kRising) - 0.01f, 0), Quat::Identity()};
    };
    return std::vector<MovingPrimitive>{moved(ball, pose(step), pose(step + 1), parameters_.time_step)};
  };
  StrandState from = restState(model, model.rest_roots);
  for (int step = 0; step < kRising; ++step)
    from = oracleStep(model, from, {&parameters_, {}, {}, bodiesAt(step)});
  const std::vector<MovingPrimitive> bodies = bodiesAt(kRising);
  const StepInput input{&parameters_, {}, {}, bodies};
  const double substep = parameters_.time_step / parameters_.substeps;
  const StrandState truth = oracleStep(model, from, input);
  const std::vector<double> error = errors(model, stepped(model, from, input), truth, substep),
                            sensitivity = sensitivities(model, from, truth, input, substep);
  const double tolerance = parameters_.solver == SolverKind::kRod ? kAmongBodiesTolerance : kOneStepTolerance;
  double worst = 0;
  size_t in_ball = 0, out_of_it = 0;
  for (size_t s = 0; s < model.strands(); ++s) {
    worst = std::max(worst, error[s]);
    EXPECT_LT(error[s], tolerance + kSensitivityFactor * sensitivity[s]) << "strand " << s;
    const uint32_t root = model.offsets[s], tip = model.offsets[s + 1] - 1;
    in_ball += signedDistance(bodies[0], truth.positions[root + 1], {}) < -2e-3f;
    out_of_it += signedDistance(bodies[0], truth.positions[tip], {}) > 0;
  }
  std::printf("             %zu strands of %zu start in the ball: %.1e of a strand's length\n", in_ball,
              model.strands(), worst);
  EXPECT_GT(in_ball, 10u);
  EXPECT_EQ(out_of_it, model.strands());
}

// Sixty balls around the head and in the hair, most of them out of any strand's reach, under a moving head.
// Only strands of the rod keep their length and get lists of near bodies.
TEST_P(Conformance, ListsOfNearBodiesChangeNoBit) {
  StrandModel model = awkwardModel(65, 19), tied = model;
  tieToBones(tied);
  std::vector<RigidBody> bodies;
  std::mt19937 random(20);
  std::uniform_real_distribution<float> place(-1, 1);
  for (int i = 0; i < 60; ++i) {
    RigidBody ball{
        {{PrimitiveKind::kSphere, Vec3(place(random), place(random), place(random)), Vec3::UnitY(), 0.03f}}};
    bodies.push_back(ball);
  }
  for (const StrandModel* one : {&model, &tied}) {
    Simulation simulation(*one, bodies, parameters_, GetParam().create());
    backend_->load(*one, simulation.state());
    size_t listed = 0, possible = 0;
    for (int i = 1; i <= 3; ++i) {
      simulation.setHeadPose(
          {Vec3(0.005f * i, 0, 0), Quat(Eigen::AngleAxisf(0.01f * i, Eigen::Vector3f::UnitY()))});
      backend_->upload(simulation.state());
      StepInput input = simulation.nextInput();
      ASSERT_EQ(input.near != nullptr, parameters_.solver == SolverKind::kRod);
      if (input.near == nullptr) return;
      listed += input.near->bodies.size();
      possible += (input.near->offsets.size() - 1) * bodies.size();
      input.near = nullptr;
      backend_->step(input);
      simulation.step();
      StrandState state;
      backend_->download(state);
      EXPECT_EQ(stateHash(state), stateHash(simulation.state())) << "step " << i;
    }
    EXPECT_LE(listed, one == &model ? possible / 2 : possible);
  }
}

TEST_P(Conformance, ContactForcesAreForgottenWithTheirBodies) {
  const StrandModel model = awkwardModel(33, 23);
  const StrandState from = restState(model, model.rest_roots);
  const auto bodies = movingBodies(parameters_.time_step);
  backend_->load(model, from);
  const StepInput with{&parameters_, {}, {}, bodies}, without{&parameters_};
  const auto pressed = [&] {
    StrandState state;
    backend_->download(state);
    return std::any_of(state.contacts.begin(), state.contacts.end(),
                       [](const Vec3& force) { return force.squaredNorm() > 0; });
  };
  backend_->step(with);
  EXPECT_EQ(pressed(), parameters_.solver == SolverKind::kRod);
  backend_->step(without);
  EXPECT_FALSE(pressed());
}

// A vertex lies just above a plane, straight below its root, on an edge whose exact length puts it deep below
// the plane. Turning it towards the nearest point of the plane does not move it.
TEST_P(Conformance, AnEdgeThatGoesStraightInComesOutAllTheWay) {
  if (parameters_.solver != SolverKind::kRod) return;  // only the rod sets exact lengths
  constexpr float kRoot = 0.004f, kLength = 0.008f;    // m
  StrandSet set;
  set.append(std::vector<Vec3>{Vec3(0, kRoot, 0), Vec3(0, kRoot - kLength, 0)});
  const StrandModel model = makeStrandModel(set);
  StrandState from = restState(model, model.rest_roots);
  from.positions[1].y() = 5e-4f;
  ContactPrimitive plane;
  plane.kind = PrimitiveKind::kPlane;
  const std::vector<MovingPrimitive> bodies{moved(plane, {}, {}, parameters_.time_step)};
  Parameters parameters = parameters_;
  parameters.substeps = 1;
  const StrandState state = stepped(model, from, StepInput{&parameters, {}, {}, bodies});
  EXPECT_NEAR((state.positions[1] - state.positions[0]).norm(), kLength, 1e-6f);
  EXPECT_GT(state.positions[1].y(), 0);
}

// Two planes meet in a crease. The edge is so short and its root so deep that its end cannot be outside of
// both. Turning it fully out of one plane puts it 1.1 mm into the other; the optimum is 0.3 mm deep in both.
TEST_P(Conformance, AnEdgeInACreaseIsLeftWhereItIsLeastDeep) {
  if (parameters_.solver != SolverKind::kRod) return;
  const Vec3 root(-0.00318f, -0.0075f, 0), placed(0.00026f, 0.0002f, 0);  // placed: 0.2 mm outside of both
  constexpr float kLength = 0.00774f;                                     // m, 0.7 mm too short
  StrandSet set;
  set.append(std::vector<Vec3>{root, root + Vec3(0, kLength, 0)});
  StrandModel model = makeStrandModel(set);
  model.rest_distance = {-0.01f, kFarFromBodies};  // the root may be 1 cm deep
  StrandState from = restState(model, model.rest_roots);
  from.positions[1] = placed;
  ContactPrimitive plane;
  plane.kind = PrimitiveKind::kPlane;
  ContactPrimitive wall = plane;
  wall.b = Vec3(0.96825f, -0.25f, 0);
  const std::vector<MovingPrimitive> bodies{moved(plane, {}, {}, parameters_.time_step),
                                            moved(wall, {}, {}, parameters_.time_step)};
  Parameters parameters = parameters_;
  parameters.substeps = 1;
  const StrandState state = stepped(model, from, StepInput{&parameters, {}, {}, bodies});
  EXPECT_NEAR((state.positions[1] - state.positions[0]).norm(), kLength, 1e-6f);
  for (const MovingPrimitive& body : bodies) EXPECT_GT(signedDistance(body, state.positions[1], {}), -5e-4f);
}

// A body with a crease moves. Relative to it, a vertex slides close along the floor of the crease into its
// wall. The plane of the floor, which it only grazes, must not stand in for the wall.
TEST_P(Conformance, WhatGrazesOneSideOfACreaseIsHeldByTheOther) {
  if (parameters_.solver != SolverKind::kRod) return;
  ContactPrimitive solid;
  solid.kind = PrimitiveKind::kField;
  const Box box(Eigen::Vector3f::Constant(-0.01f), Eigen::Vector3f::Constant(0.01f));
  solid.field = std::make_shared<DistanceField>(
      sampledField([](const Vec3& p) { return std::min(p.x(), p.y()); }, box, 5e-4f, 0.006f));
  ShapeData shapes;
  const uint32_t data = shapes.add(solid);
  const Pose comes{Vec3(0.004f, 0, 0), Quat::Identity()};
  const std::vector<MovingPrimitive> bodies{moved(solid, {}, comes, parameters_.time_step, data)};
  StrandSet set;  // 0.1 mm above the floor, 2 mm from the wall
  set.append(std::vector<Vec3>{Vec3(0.003f, 0.008f, 0), Vec3(0.002f, 1e-4f, 0)});
  StrandModel model = makeStrandModel(set);
  model.rest_distance = {-0.01f, kFarFromBodies};  // the root may be 1 cm deep
  Parameters parameters = parameters_;
  parameters.substeps = 1;
  parameters.gravity = Vec3::Zero();
  const StepInput input{&parameters, {}, {}, bodies, {}, &shapes};
  const StrandState state = stepped(model, restState(model, model.rest_roots), input);
  EXPECT_GT(signedDistance(bodies[0], state.positions[1], shapes.words), -2e-4f);
}

// Hair on a ball that is a distance field, with its first vertices inside. The ball rotates and slides while
// a box is pushed through the hair.
TEST_P(Conformance, FieldsAndBoxesHoldHairOutOver60Steps) {
  StrandSet set;
  std::mt19937 random(75);
  std::uniform_real_distribution<float> range(-1, 1);
  for (int s = 0; s < 61; ++s) {
    const Vec3 out = Vec3(range(random), 0.3f + std::fabs(range(random)), range(random)).normalized();
    std::vector<Vec3> points;
    for (int i = 0; i < 16; ++i) points.push_back(out * (0.085f + 0.01f * i));
    set.append(points);
  }
  ContactPrimitive ball;
  ball.kind = PrimitiveKind::kField;
  const Box box(Eigen::Vector3f::Constant(-0.1f), Eigen::Vector3f::Constant(0.1f));
  ball.field = std::make_shared<DistanceField>(
      sampledField([](const Vec3& p) { return p.norm() - 0.1f; }, box, 0.005f, 0.02f));
  RigidBody head{{ball}, true, true};
  Simulation simulation(makeStrandModel(set), {head}, parameters_, GetParam().create());
  ContactPrimitive slab;
  slab.kind = PrimitiveKind::kBox;
  slab.extent = Vec3(0.05f, 0.01f, 0.05f);
  const BodyId pushed = simulation.addBody({{slab}, false, false, {Vec3(0, 0.4f, 0), Quat::Identity()}});
  Measurement worst;
  size_t in_ball = 0;
  for (const float distance : simulation.model().rest_distance) in_ball += distance < 0;
  for (int step = 1; step <= 60; ++step) {
    const float t = static_cast<float>(step) / 60;
    const Quat nod(Eigen::AngleAxisf(0.3f * std::sin(6 * t), Eigen::Vector3f::UnitX()));
    simulation.setHeadPose({Vec3(0.05f * std::sin(4 * t), 0, 0), nod});
    simulation.setBodyPose(pushed, {Vec3(0, 0.4f - 0.2f * t, 0), nod});
    simulation.step();
    const Measurement now = simulation.measure();
    worst.max_penetration = std::max(worst.max_penetration, now.max_penetration);
    worst.non_finite += now.non_finite;
  }
  std::printf("             penetration %.2e m\n", worst.max_penetration);
  EXPECT_EQ(worst.non_finite, 0u);
  EXPECT_EQ(in_ball, 2u * 61u);
  // Inextensible hair must buckle before it yields to a box that approaches its tip (measured: 1.0 mm on
  // every backend).
  EXPECT_LT(worst.max_penetration, parameters_.solver == SolverKind::kRod ? 2e-3 : 1e-3);
}

}  // namespace
}  // namespace strandcast
