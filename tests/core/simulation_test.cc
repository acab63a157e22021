#include "core/simulation.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "core/error.h"
#include "tests/conformance/conformance_model.h"

namespace strandcast {
namespace {

constexpr uint64_t kGoldenHash = 9277578725521340165ull;
constexpr uint64_t kTeleportHash = 4455343052807784181ull;

// Two straight strands of 9 vertices and 16 cm along x, and a curled one of 6 vertices.
StrandModel smallModel() {
  StrandSet set;
  for (float z : {0.0f, 0.05f}) {
    std::vector<Vec3> points;
    for (int i = 0; i < 9; ++i) points.push_back(Vec3(0.02f * i, 0, z));
    set.append(points);
  }
  std::vector<Vec3> curl;
  for (int i = 0; i < 6; ++i) curl.push_back(Vec3(0.02f * std::cos(i), 0.02f * std::sin(i), 0.005f * i));
  set.append(curl);
  return makeStrandModel(set);
}

Parameters gaussSeidel() {
  Parameters parameters;
  parameters.solver = SolverKind::kGaussSeidel;
  return parameters;
}

Simulation makeSimulation(const Parameters& parameters, std::vector<RigidBody> bodies = {}) {
  return Simulation(smallModel(), std::move(bodies), parameters, makeReferenceBackend());
}

double largestDistance(const StrandState& a, const StrandState& b) {
  double worst = 0;
  for (size_t i = 0; i < a.positions.size(); ++i)
    worst = std::max<double>(worst, (a.positions[i] - b.positions[i]).norm());
  return worst;
}

TEST(Simulation, StartsAtTheRestShape) {
  Simulation simulation = makeSimulation(Parameters());
  const StrandModel model = smallModel();
  EXPECT_EQ(stateHash(simulation.state()), stateHash(restState(model, model.rest_roots)));
  EXPECT_EQ(simulation.steps(), 0u);
  EXPECT_EQ(simulation.time(), 0);
}

TEST(Simulation, AStrandAtRestWithoutGravityStaysAtRest) {
  Parameters parameters = gaussSeidel();
  parameters.gravity.setZero();
  Simulation simulation = makeSimulation(parameters);
  const StrandState before = simulation.state();
  for (int i = 0; i < 120; ++i) simulation.step();
  // Rounding of the rest shape in its frames moves vertices by a few units in the last place of 16 cm (1.5e-8
  // m each), and does not grow. An angular constraint without its reaction on the preceding edge made the
  // curl flutter by 4 cm here.
  EXPECT_LT(largestDistance(simulation.state(), before), 2e-7);
  for (const Vec3& velocity : simulation.state().velocities) EXPECT_LT(velocity.norm(), 2e-5f);
  EXPECT_NEAR(simulation.time(), 2.0, 1e-5);
}

TEST(Simulation, ALimpStrandSwingsLikeAPendulum) {
  Parameters parameters = gaussSeidel();
  parameters.shape_rate = parameters.shape_rate_tip = 0;
  parameters.air_drag = 0;
  parameters.substeps = 16;
  parameters.iterations = 16;
  Simulation simulation = makeSimulation(parameters);
  float lowest = 0, leftmost = 1;
  for (int i = 0; i < 60; ++i) {
    simulation.step();
    const Vec3 tip = simulation.guides()[8];
    lowest = std::min(lowest, tip.y());
    leftmost = std::min(leftmost, tip.x());
    EXPECT_NEAR(tip.z(), 0, 1e-5);
  }
  EXPECT_LT(lowest, -0.15f) << "it falls to below the root, 16 cm";
  EXPECT_GT(lowest, -0.17f) << "but no further than it is long";
  EXPECT_LT(leftmost, -0.05f) << "and swings through to the other side";
}

TEST(Simulation, FreeVerticesFallAsGravitySays) {
  Parameters parameters;
  parameters.shape_rate = parameters.shape_rate_tip = 0;
  parameters.air_drag = 0;
  Simulation simulation = makeSimulation(parameters);
  simulation.step();
  // Until constraints propagate from the root, the tip falls freely: symplectic Euler, g h^2 n (n + 1) / 2.
  const double h = parameters.time_step / parameters.substeps;
  EXPECT_NEAR(simulation.guides()[8].y(), -9.81 * h * h * 10, 2e-5);
}

TEST(Simulation, DragBringsHairToTheSpeedOfTheWind) {
  Parameters parameters;
  parameters.gravity.setZero();
  parameters.shape_rate = parameters.shape_rate_tip = 0;
  parameters.wind = Vec3(0, 0, 2);
  parameters.air_drag = 5;
  Simulation simulation = makeSimulation(parameters);
  for (int i = 0; i < 240; ++i) simulation.step();
  const Vec3 tip = simulation.guides()[8];
  EXPECT_GT(tip.z(), 0.12f) << "it streams along z";
}

TEST(Simulation, TheHeadCarriesItsHairAndItsBodies) {
  Parameters parameters;
  RigidBody head{{{PrimitiveKind::kSphere, Vec3(0, -0.5f, 0), Vec3::UnitY(), 0.45f, 0.3f}}, true};
  Simulation simulation = makeSimulation(parameters, {head});
  const Pose there{Vec3(0.1f, 0, 0), Quat(Eigen::AngleAxisf(0.1f, Eigen::Vector3f::UnitY()))};
  simulation.setHeadPose(there);
  simulation.step();
  const StrandModel model = smallModel();
  for (size_t s = 0; s < model.strands(); ++s) {
    const Vec3 root = simulation.guides()[model.offsets[s]];
    EXPECT_LT((root - (there * model.rest_roots[s]).position).norm(), 1e-6f);
  }
  EXPECT_LT((simulation.headPose().position - there.position).norm(), 1e-6f);
  for (int i = 0; i < 60; ++i) simulation.step();
  EXPECT_LT(simulation.measure().max_penetration, 1e-5);
  EXPECT_EQ(simulation.measure().non_finite, 0u);
}

TEST(Simulation, ResetGoesBackToTheRestShapeAtThePresentHead) {
  Simulation simulation = makeSimulation(Parameters());
  const Pose there{Vec3(0.1f, 0.2f, 0.3f), Quat(Eigen::AngleAxisf(0.4f, Eigen::Vector3f::UnitX()))};
  simulation.setHeadPose(there);
  for (int i = 0; i < 30; ++i) simulation.step();
  simulation.reset();
  const StrandModel model = smallModel();
  std::vector<Pose> roots;
  for (const Pose& root : model.rest_roots) roots.push_back(there * root);
  EXPECT_EQ(stateHash(simulation.state()), stateHash(restState(model, roots)));
}

TEST(Simulation, ResetRunsTheSameAgain) {
  Simulation simulation = makeSimulation(Parameters());
  for (int i = 0; i < 20; ++i) simulation.step();
  const uint64_t hash = stateHash(simulation.state());
  simulation.reset();
  for (int i = 0; i < 20; ++i) simulation.step();
  EXPECT_EQ(stateHash(simulation.state()), hash);
}

TEST(Simulation, TeleportCarriesTheHairRigidlyWithoutMotionInBetween) {
  Parameters parameters;
  parameters.gravity.setZero();
  Simulation simulation = makeSimulation(parameters);
  const StrandState before = simulation.state();
  const Pose far{Vec3(3, 0, 0), Quat(Eigen::AngleAxisf(1.0f, Eigen::Vector3f::UnitZ()))};
  simulation.teleport(far);
  StrandState expected = before;
  for (Vec3& position : expected.positions) position = far.apply(position);
  EXPECT_LT(largestDistance(simulation.state(), expected), 1e-5);
  for (int i = 0; i < 10; ++i) simulation.step();
  EXPECT_LT(largestDistance(simulation.state(), expected), 1e-4) << "no step sees the way in between";
}

/// Largest distance, m, between corresponding guide vertices, each relative to its own head.
double differenceOfShapes(Simulation& a, Simulation& b) {
  const std::span<const Vec3> of_a = a.guides(), of_b = b.guides();
  double worst = 0;
  for (size_t v = 0; v < of_a.size(); ++v) {
    const Vec3 difference = (of_a[v] - a.headPose().position) - (of_b[v] - b.headPose().position);
    worst = std::max<double>(worst, difference.norm());
  }
  return worst;
}

TEST(Simulation, FarFromTheOriginHairDoesAsItDoesAtIt) {
  constexpr float kFar = 1000;
  const Vec3 there(kFar, 2, -kFar);
  RigidBody head{{{PrimitiveKind::kSphere, Vec3(0, -0.4f, 0), Vec3::UnitY(), 0.35f, 0.3f}}, true};
  RigidBody ball{{{PrimitiveKind::kSphere, Vec3(0.1f, -0.1f, 0), Vec3::UnitY(), 0.08f, 0.3f}}};
  Simulation here = makeSimulation(Parameters(), {head, ball});
  ball.pose.position = there;
  Simulation far = makeSimulation(Parameters(), {head, ball});
  far.teleport({there, Quat::Identity()});
  EXPECT_EQ(far.origin(), there);
  double stretch = 0;
  for (int i = 0; i < 90; ++i) {
    const Vec3 nod(0, static_cast<float>(i % 8) / 1024,
                   0);  // multiples of 1/1024 m: representable in float at 1 km
    here.setHeadPose({nod, Quat::Identity()});
    far.setHeadPose({there + nod, Quat::Identity()});
    here.step();
    far.step();
    stretch = std::max(stretch, far.measure().max_stretch);
    EXPECT_LT(far.measure().max_penetration, 1e-3);
  }
  EXPECT_LT(stretch, 1e-4);
  EXPECT_LT(differenceOfShapes(here, far), 2e-4) << "a float there tells 0.06 mm";
  EXPECT_LT((far.state().positions[0] - there).norm(), 0.1f) << "in the world";
  far.reset();
  here.setHeadPose({});
  here.step();
  here.reset();
  far.setHeadPose({there, Quat::Identity()});
  far.step();
  far.reset();
  EXPECT_LT(differenceOfShapes(here, far), 1e-4);
  far.teleport({});
  EXPECT_TRUE(far.origin().isZero());
  EXPECT_LT(differenceOfShapes(here, far), 1e-5);
}

TEST(Simulation, TheOriginFollowsAHeadThatWalks) {
  Parameters parameters;
  parameters.air_drag = 5;
  Simulation walks = makeSimulation(parameters), stands = makeSimulation(parameters);
  float way = 0;
  for (; way < 20; way += 0.0625f) {
    walks.setHeadPose({Vec3(0, 0, way), Quat::Identity()});
    walks.step();
    EXPECT_EQ(walks.resetDiverged(), 0u);
    EXPECT_LE((walks.headPose().position - walks.origin()).norm(), kFarFromOrigin);
  }
  EXPECT_GT(walks.origin().z(), 10);
  for (int i = 0; i < 600; ++i) {
    walks.step();
    stands.step();
  }
  EXPECT_LT(walks.measure().max_stretch, 1e-4);
  EXPECT_LT(differenceOfShapes(walks, stands), 1e-4);
}

/// smallModel() without gravity after 20 steps in which its two bones move differently. The bone "arm"
/// carries the second strand.
Simulation onTwoBones() {
  StrandModel model = smallModel();
  pinToBone(model, 1, 0, 0, "arm");
  Parameters parameters;
  parameters.gravity.setZero();
  Simulation simulation(std::move(model), {}, parameters, makeReferenceBackend());
  for (int i = 1; i <= 20; ++i) {
    simulation.setHeadPose({Vec3(0, 0.002f * i, 0), Quat(Eigen::AngleAxisf(0.03f * i, Vec3::UnitZ()))});
    simulation.setBonePose("arm",
                           {Vec3(0, 0, 0.002f * i), Quat(Eigen::AngleAxisf(0.03f * i, Vec3::UnitY()))});
    simulation.step();
  }
  return simulation;
}

/// Largest distance, m, and largest difference of velocities, m/s, between two simulations of one model, each
/// strand seen from the bone of its root.
std::pair<float, float> differenceOnBones(Simulation& a, Simulation& b) {
  const StrandModel& model = a.model();
  const StrandState of_a = a.state(), of_b = b.state();
  float place = 0, speed = 0;
  for (size_t s = 0; s < model.strands(); ++s) {
    const Pose from_a = a.bonePose(model.rootBone(s)).inverse(),
               from_b = b.bonePose(model.rootBone(s)).inverse();
    for (uint32_t v = model.offsets[s]; v < model.offsets[s + 1]; ++v) {
      place = std::max(place, (from_a.apply(of_a.positions[v]) - from_b.apply(of_b.positions[v])).norm());
      speed = std::max(speed, (from_a.rotate(of_a.velocities[v]) - from_b.rotate(of_b.velocities[v])).norm());
    }
  }
  return {place, speed};
}

TEST(Simulation, ACutMovesEachStrandRigidlyWithItsBone) {
  Simulation cut = onTwoBones(), uncut = onTwoBones();
  const StrandState before = cut.state();
  const Pose there{Vec3(3, 1, -2), Quat(Eigen::AngleAxisf(2.0f, Eigen::Vector3f(1, 2, 3).normalized()))};
  cut.setBonePose("arm", there);
  cut.jumpToPoses();
  EXPECT_EQ(cut.bonePose(1).position, there.position);
  EXPECT_EQ(cut.steps(), uncut.steps());
  const auto [place, speed] = differenceOnBones(cut, uncut);
  EXPECT_LT(place, 1e-6f);
  EXPECT_LT(speed, 2e-6f);
  const StrandState after = cut.state();
  EXPECT_GT(before.velocities[8].norm(), 0.1f) << "the hair moves";
  EXPECT_LT((after.positions[8] - before.positions[8]).norm(), 1e-6f) << "the head stays where it is";
  EXPECT_GT((after.positions[17] - before.positions[17]).norm(), 3);
  for (int i = 0; i < 30; ++i) {
    cut.step();
    uncut.step();
    EXPECT_EQ(cut.resetDiverged(), 0u);
    EXPECT_LT(differenceOnBones(cut, uncut).first, 1e-5f) << "no step sees the way in between: " << i;
  }
}

TEST(Simulation, ACutFarAwayKeepsTheShapeOfHairToAMicrometre) {
  Simulation cut = onTwoBones();
  const auto shape = [&] {
    std::vector<Vec3> edges;
    for (size_t s = 0; s < cut.model().strands(); ++s) {
      const Quat back = cut.bonePose(cut.model().rootBone(s)).rotation.conjugate();
      for (uint32_t v = cut.model().offsets[s]; v < cut.model().offsets[s + 1]; ++v)
        edges.push_back(back * (cut.backend().guides()[v] - cut.backend().guides()[cut.model().offsets[s]]));
    }
    return edges;
  };
  const std::vector<Vec3> before = shape();
  const Vec3 far(1000, 2, -1000);
  for (const Pose& there : {Pose{far, Quat(Eigen::AngleAxisf(1, Vec3::UnitX()))}, Pose{}}) {
    cut.setHeadPose(there);
    cut.setBonePose("arm", {there.position + Vec3(0.5f, 0, 0), there.rotation});
    cut.jumpToPoses();
    EXPECT_EQ(cut.origin(), there.position);
    const std::vector<Vec3> now = shape();
    for (size_t v = 0; v < now.size(); ++v) EXPECT_LT((now[v] - before[v]).norm(), 2e-6f) << v;
  }
}

TEST(Simulation, ACutTakesBodiesToTheirPoses) {
  RigidBody ball{{{PrimitiveKind::kSphere, Vec3(0, -0.5f, 0), Vec3::UnitY(), 0.1f, 0.3f}}};
  RigidBody head = ball;
  head.follows_head = true;
  Simulation simulation = makeSimulation(Parameters(), {ball, head});
  simulation.setBodyPose(0, {Vec3(0, 0, 1), Quat::Identity()});
  simulation.setHeadPose({Vec3(0, 1, 0), Quat::Identity()});
  simulation.jumpToPoses();
  EXPECT_EQ(simulation.bodyPose(0).position, Vec3(0, 0, 1));
  const StepInput input = simulation.nextInput();
  ASSERT_EQ(input.primitives.size(), 2u);
  for (const MovingPrimitive& body : input.primitives)
    for (int c = 0; c < 3; ++c) EXPECT_EQ(body.a_begin[c], body.a_end[c]);
  EXPECT_EQ(input.primitives[0].a_begin[2], 1);
  EXPECT_EQ(input.primitives[1].a_begin[1], 0.5f);
}

TEST(Simulation, ATeleportIsACutOfTheHead) {
  const Pose there{Vec3(7, 0, 3), Quat(Eigen::AngleAxisf(1.0f, Eigen::Vector3f::UnitZ()))};
  Simulation teleported = makeSimulation(Parameters()), cut = makeSimulation(Parameters());
  for (Simulation* one : {&teleported, &cut})
    for (int i = 0; i < 10; ++i) one->step();
  teleported.teleport(there);
  cut.setHeadPose(there);
  cut.jumpToPoses();
  EXPECT_EQ(stateHash(teleported.state()), stateHash(cut.state()));
}

// The teleport discards what was set for the arm, and the body goes on moving.
TEST(Simulation, ATeleportKeepsItsGoldenHash) {
  StrandModel model = smallModel();
  pinToBone(model, 1, 0, 0, "arm");
  RigidBody ball{{{PrimitiveKind::kSphere, Vec3(0.1f, -0.06f, 0), Vec3::UnitY(), 0.05f, 0.3f}}};
  Simulation simulation(model, {ball}, Parameters(), makeReferenceBackend());
  for (int i = 0; i < 20; ++i) simulation.step();
  for (const Vec3& place : {Vec3(1, 0.5f, 2), Vec3(100.3f, 7, -1000), Vec3(0, 0, 0)}) {
    simulation.setBonePose("arm", {Vec3(9, 9, 9), Quat::Identity()});
    simulation.setBodyPose(0, {Vec3(0.01f * place.x(), 0, 0), Quat::Identity()});
    simulation.teleport({place, Quat(0.8f, 0, 0, 0.6f)});
    for (int i = 0; i < 5; ++i) simulation.step();
  }
  EXPECT_EQ(stateHash(simulation.state()), kTeleportHash);
}

TEST(Simulation, BodiesThatMayBendDoAndOthersAreRefused) {
  const auto ball = [](const Vec3& p) { return p.norm() - 0.05f; };
  ContactPrimitive shape;
  shape.kind = PrimitiveKind::kField;
  shape.field = std::make_shared<DistanceField>(sampledField(
      ball, Box(Eigen::Vector3f::Constant(-0.05f), Eigen::Vector3f::Constant(0.05f)), 0.004f, 0.01f));
  shape.a = Vec3(0, -0.4f, 0);
  Simulation simulation = makeSimulation(Parameters());
  const BodyId stiff = simulation.addBody({.primitives = {shape}});
  const BodyId soft = simulation.addBody({.primitives = {shape}, .bends = true});
  SurfaceBend bend;
  bend.terms[0] = Vec3(0, 0.01f, 0);
  EXPECT_THROW(simulation.setBodyBend(stiff, bend), Error);
  EXPECT_THROW(simulation.setBodyBend(soft + 1, bend), Error);
  bend.terms[4].x() = NAN;
  EXPECT_THROW(simulation.setBodyBend(soft, bend), Error);
  shape.rotation = Quat(Eigen::AngleAxisf(0.1f, Eigen::Vector3f::UnitX()));
  EXPECT_THROW(simulation.addBody({.primitives = {shape}, .bends = true}), Error);

  bend.terms[4].setZero();
  simulation.removeBody(stiff);
  simulation.setBodyBend(soft, bend);
  const StepInput input = simulation.nextInput();
  ASSERT_EQ(input.primitives.size(), 1u);
  EXPECT_NEAR(signedDistance(input.primitives[0], Vec3(0, -0.36f, 0), input.shapes->words), 0, 5e-4)
      << "what is there was a centimetre higher at rest, on the surface";
  simulation.step();
  simulation.step();
  EXPECT_NEAR(signedDistance(simulation.nextInput().primitives[0], Vec3(0, -0.36f, 0), input.shapes->words),
              0, 5e-4);
  simulation.setBodyBend(soft, {});
  simulation.step();
  simulation.step();
  EXPECT_FALSE(isBent(simulation.nextInput().primitives[0]));
}

TEST(Simulation, StandingBodiesStayWhereTheyAre) {
  RigidBody floor{{{PrimitiveKind::kPlane, Vec3(0, -0.05f, 0), Vec3::UnitY(), 0, 0.5f}}, false};
  Parameters parameters;
  parameters.shape_rate = parameters.shape_rate_tip = 0;
  Simulation simulation = makeSimulation(parameters, {floor});
  for (int i = 0; i < 120; ++i) simulation.step();
  for (const Vec3& position : simulation.guides()) EXPECT_GT(position.y(), -0.05f);
  EXPECT_LT(simulation.guides()[8].y(), -0.049f) << "the tip lies on the floor";
}

// The reference backend computes the same bits with every compiler and optimisation level: contraction is off
// and fused multiply-adds are explicit. A change of the hash is a change of the physics; note it in the
// change log.
TEST(Simulation, TheReferenceBackendKeepsItsGoldenHash) {
  RigidBody head{{{PrimitiveKind::kSphere, Vec3(0.08f, -0.06f, 0), Vec3::UnitY(), 0.05f, 0.3f}}, true};
  Parameters parameters = gaussSeidel();
  parameters.wind = Vec3(0.5f, 0, 1);
  Simulation simulation = makeSimulation(parameters, {head});
  for (int i = 1; i <= 60; ++i) {
    simulation.setHeadPose({Vec3(0.0005f * i, 0, 0), Quat::Identity()});
    simulation.step();
  }
  EXPECT_EQ(stateHash(simulation.state()), kGoldenHash);
}

TEST(Simulation, AStrandThatWentWrongIsResetAlone) {
  StrandSet set;
  for (int s = 0; s < 3; ++s) {
    const auto x = static_cast<float>(s);
    set.append(std::vector<Vec3>{Vec3(x, 0, 0), Vec3(x, -0.1f, 0), Vec3(x, -0.2f, 0)});
  }
  Parameters parameters;
  parameters.solver = SolverKind::kRod;
  Simulation simulation(makeStrandModel(set), {}, parameters, makeReferenceBackend());
  for (int i = 0; i < 10; ++i) simulation.step();
  EXPECT_EQ(simulation.resetDiverged(), 0u);
  StrandState state = simulation.state();
  state.positions[4].x() = std::numeric_limits<float>::quiet_NaN();
  simulation.backend().upload(state);
  simulation.step();
  EXPECT_EQ(simulation.measure().non_finite, 2u) << "of the second strand, all but its root";
  EXPECT_EQ(simulation.resetDiverged(), 1u);
  EXPECT_EQ(simulation.measure().non_finite, 0u);
  simulation.step();
  EXPECT_EQ(simulation.resetDiverged(), 0u);
}

// Error message of a call with invalid input. Checks the strong exception guarantee: later steps give the
// same bits as without the call.
std::string refusal(const std::function<void(Simulation&)>& call) {
  Simulation simulation = makeSimulation(Parameters()), untouched = makeSimulation(Parameters());
  std::string what;
  try {
    call(simulation);
  } catch (const Error& error) {
    what = error.what();
  }
  for (Simulation* one : {&simulation, &untouched})
    for (int i = 0; i < 3; ++i) one->step();
  EXPECT_EQ(stateHash(simulation.state()), stateHash(untouched.state())) << what;
  return what;
}

TEST(Simulation, PosesThatAreNotFiniteOrNotRotationsAreRefused) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  const Quat one = Quat::Identity();
  for (const auto& [pose, complaint] :
       {std::pair(Pose{Vec3(0, nan, 0), one}, "not finite"),
        std::pair(Pose{Vec3(nan, 0, 0), one}, "not finite"),
        std::pair(Pose{Vec3(0, 0, -inf), one}, "not finite"),
        std::pair(Pose{Vec3(0, 2e4f, 0), one}, "too far away"),
        std::pair(Pose{Vec3(0, 0, 0), Quat(nan, 0, 0, 0)}, "unit quaternion"),
        std::pair(Pose{Vec3(0, 0, 0), Quat(1, inf, 0, 0)}, "unit quaternion"),
        std::pair(Pose{Vec3(0, 0, 0), Quat(0, 0, 0, 0)}, "unit quaternion"),
        std::pair(Pose{Vec3(0, 0, 0), Quat(1, 1, 0, 0)}, "unit quaternion")}) {
    const Pose bad = pose;
    const std::string set = refusal([&](Simulation& s) { s.setHeadPose(bad); });
    EXPECT_NE(set.find(complaint), std::string::npos) << set;
    EXPECT_NE(set.find("Simulation::setHeadPose"), std::string::npos) << set;
    const std::string teleported = refusal([&](Simulation& s) { s.teleport(bad); });
    EXPECT_NE(teleported.find(complaint), std::string::npos) << teleported;
    EXPECT_NE(teleported.find("Simulation::teleport"), std::string::npos) << teleported;
  }
  Simulation simulation = makeSimulation(Parameters());
  EXPECT_NO_THROW(simulation.setHeadPose({Vec3::Zero(), Quat(1.00001f, 0, 0, 0)}))
      << "as products of rotations in float come out";
}

TEST(Simulation, ParametersOutOfRangeAreRefused) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  auto with = [](auto change) {
    return refusal([&](Simulation& s) {
      Parameters parameters = s.parameters();
      change(parameters);
      s.setParameters(parameters);
    });
  };
  const std::string wind = with([&](Parameters& p) { p.wind.y() = nan; });
  EXPECT_NE(wind.find("'wind'"), std::string::npos) << wind;
  EXPECT_NE(wind.find("Simulation::setParameters"), std::string::npos) << wind;
  EXPECT_NE(with([&](Parameters& p) { p.time_step = nan; }).find("'time_step'"), std::string::npos);
  EXPECT_NE(with([](Parameters& p) { p.substeps = 0; }).find("'substeps'"), std::string::npos);
  EXPECT_NE(with([](Parameters& p) { p.solver = SolverKind::kGaussSeidel; }).find("cannot change"),
            std::string::npos);
  EXPECT_NE(with([](Parameters& p) { p.solver = static_cast<SolverKind>(7); }).find("unknown solver"),
            std::string::npos);
  Parameters bad;
  bad.gravity.x() = nan;
  EXPECT_THROW(makeSimulation(bad), Error);
  StrandModel broken = smallModel();
  broken.rest_local[3].y() = nan;
  EXPECT_THROW(Simulation(broken, {}, Parameters(), makeReferenceBackend()), Error);
  EXPECT_THROW(Simulation(smallModel(), {}, Parameters(), nullptr), Error);
  const ContactPrimitive ball{PrimitiveKind::kSphere, Vec3(0, nan, 0), Vec3::UnitY(), 0.1f, 0.3f};
  EXPECT_THROW(makeSimulation(Parameters(), {{{ball}, true}}), Error);
}

RigidBody floorAt(float height) {
  RigidBody floor{{{PrimitiveKind::kBox, Vec3(0, -0.5f, 0), Vec3::UnitY(), 0, 0.8f}}};
  floor.primitives[0].extent = Vec3(1, 0.5f, 1);
  floor.pose.position.y() = height;
  return floor;
}

TEST(Simulation, TheRodTakesNoSubstepLongerThanASixtiethOfASecond) {
  const auto run = [](float time_step, int substeps) {
    Parameters parameters;
    parameters.solver = SolverKind::kRod;
    parameters.time_step = time_step;
    parameters.substeps = substeps;
    Simulation simulation = makeSimulation(parameters);
    for (int i = 0; i < 10; ++i) simulation.step();
    EXPECT_EQ(simulation.parameters().substeps, substeps) << "as it was told";
    return stateHash(simulation.state());
  };
  EXPECT_EQ(run(1.0f / 30, 1), run(1.0f / 30, 2));
  EXPECT_NE(run(1.0f / 60, 1), run(1.0f / 60, 2));
}

TEST(Simulation, BodiesComeMoveAndGo) {
  Parameters parameters;
  parameters.solver = SolverKind::kRod;
  Simulation simulation = makeSimulation(parameters);
  const BodyId far = simulation.addBody(floorAt(-3));
  const BodyId floor = simulation.addBody(floorAt(-0.05f));
  for (int i = 0; i < 120; ++i) simulation.step();
  EXPECT_LT(simulation.measure().max_penetration, 1e-4);
  EXPECT_NEAR(simulation.guides()[8].y(), -0.05f, 2e-4) << "the tip lies on the floor";
  simulation.removeBody(far);
  EXPECT_EQ(simulation.bodies(), 1u);
  for (int i = 1; i <= 10; ++i) {
    simulation.setBodyPose(floor, {Vec3(0, -0.05f + 0.002f * i, 0), Quat::Identity()});
    simulation.step();
  }
  EXPECT_FLOAT_EQ(simulation.bodyPose(floor).position.y(), -0.03f);
  EXPECT_GT(simulation.guides()[8].y(), -0.0301f) << "it lifts the tip";
  simulation.removeBody(floor);
  for (int i = 0; i < 60; ++i) simulation.step();
  EXPECT_LT(simulation.guides()[8].y(), -0.1f) << "and nothing holds it any more";
  EXPECT_NE(simulation.addBody(floorAt(-1)), floor);
}

TEST(Simulation, ABodyThatStaysDoesTheSameWhateverElseIsAddedAndRemoved) {
  const auto run = [](bool others) {
    Simulation simulation = makeSimulation(Parameters(), {floorAt(-0.03f)});
    for (int i = 0; i < 20; ++i) {
      BodyId other = 0;
      if (others) other = simulation.addBody(floorAt(-9));
      simulation.step();
      if (others) simulation.removeBody(other);
    }
    return stateHash(simulation.state());
  };
  EXPECT_EQ(run(true), run(false));
}

TEST(Simulation, UnknownBodiesAndBadPosesAreRefused) {
  const auto refused = [](auto call, const char* what) {
    RigidBody head = floorAt(-2);
    head.follows_head = true;
    Simulation simulation = makeSimulation(Parameters(), {head, floorAt(-1)});
    const uint64_t before = stateHash(simulation.state());
    try {
      call(simulation);
      ADD_FAILURE() << what;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(what), std::string::npos) << error.what();
    }
    EXPECT_EQ(simulation.bodies(), 2u);
    EXPECT_EQ(stateHash(simulation.state()), before);
  };
  const Pose nowhere{Vec3(0, std::numeric_limits<float>::quiet_NaN(), 0), Quat::Identity()};
  refused([](Simulation& s) { s.setBodyPose(2, Pose()); }, "unknown body 2: Simulation::setBodyPose");
  refused([](Simulation& s) { s.setBodyPose(0, Pose()); }, "follows the head");
  refused([&](Simulation& s) { s.setBodyPose(1, nowhere); }, "Simulation::setBodyPose");
  refused([](Simulation& s) { s.removeBody(7); }, "unknown body 7: Simulation::removeBody");
  refused([](Simulation& s) { s.bodyPose(7); }, "unknown body 7: Simulation::bodyPose");
  refused(
      [&](Simulation& s) {
        RigidBody bad = floorAt(0);
        bad.pose = nowhere;
        s.addBody(bad);
      },
      "Simulation::addBody");
  refused(
      [&](Simulation& s) {
        RigidBody bad = floorAt(0);
        bad.primitives[0].extent.setZero();
        s.addBody(bad);
      },
      "no extent: Simulation::addBody");
}

// Strands start 3 cm inside a box and leave it. Vertices inside at rest are exempt from contact; vertices
// deeper than at rest are pushed back.
TEST(Simulation, HairThatIsInItsBodyAtRestIsLetBe) {
  RigidBody scalp{{{PrimitiveKind::kBox, Vec3(-0.47f, 0, 0), Vec3::UnitY(), 0, 0.3f}}, true, true};
  scalp.primitives[0].extent = Vec3(0.5f, 0.5f, 0.5f);
  Parameters parameters;
  parameters.solver = SolverKind::kRod;
  parameters.gravity.setZero();
  Simulation simulation = makeSimulation(parameters, {scalp});
  const StrandState rest = simulation.state();
  EXPECT_LT(simulation.model().rest_distance[0], -0.03f + 1e-5f);
  EXPECT_GT(simulation.model().rest_distance[8], 0.1f);
  for (int i = 0; i < 30; ++i) simulation.step();
  EXPECT_LT(largestDistance(simulation.state(), rest), 1e-5) << "nothing pops";
  EXPECT_LT(simulation.measure().max_penetration, 1e-5);
  parameters.gravity = Vec3(-9.81f, -1, 0);  // oblique: hair upright on the box would stay upright
  simulation.setParameters(parameters);
  for (int i = 0; i < 60; ++i) simulation.step();
  EXPECT_GT(largestDistance(simulation.state(), rest), 0.01) << "hair falls towards the box";
  EXPECT_LT(simulation.measure().max_penetration, 1e-3) << "and not farther into it";
}

}  // namespace
}  // namespace strandcast
