#include "core/body_set.h"

#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <limits>

#include "core/simulation.h"
#include "tests/conformance/conformance_model.h"
#include "tests/expect_error.h"

namespace strandcast {
namespace {

constexpr float kTimeStep = 1.0f / 60;  // s

ContactPrimitive ballAt(const Vec3& centre, float radius = 0.1f) {
  return {PrimitiveKind::kSphere, centre, Vec3::UnitY(), radius, 0.3f};
}

/// A ball of 5 cm as a distance field.
ContactPrimitive fieldBall(const Vec3& centre) {
  ContactPrimitive shape;
  shape.kind = PrimitiveKind::kField;
  shape.field = std::make_shared<DistanceField>(
      sampledField([](const Vec3& p) { return p.norm() - 0.05f; },
                   Box(Eigen::Vector3f::Constant(-0.05f), Eigen::Vector3f::Constant(0.05f)), 0.005f, 0.01f));
  shape.a = centre;
  return shape;
}

BodySet emptySet(size_t neighbourhoods = 0) { return {makeAllPairs(), neighbourhoods}; }

Pose poseAt(const Vec3& position, float turn = 0) {
  return {position, Quat(Eigen::AngleAxisf(turn, Eigen::Vector3f::UnitZ()))};
}

bool sameBits(const MovingPrimitive& a, const MovingPrimitive& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

TEST(BodySet, IdsCountUpAndAreNeverReused) {
  BodySet bodies = emptySet();
  for (BodyId id = 0; id < 4; ++id) EXPECT_EQ(bodies.add({{ballAt(Vec3::Zero())}}), id);
  bodies.remove(3, "test");
  bodies.remove(1, "test");
  EXPECT_EQ(bodies.add({{ballAt(Vec3::UnitX())}}), 4u);
  EXPECT_EQ(bodies.ids(), (std::vector<BodyId>{0, 2, 4})) << "in the order in which they were added";
  EXPECT_EQ(bodies.size(), 3u);
  EXPECT_TRUE(bodies.has(2));
  EXPECT_FALSE(bodies.has(3));
  EXPECT_EQ(bodies.body(4, "test").primitives[0].a, Vec3(Vec3::UnitX()));
}

TEST(BodySet, UnknownBodiesAreRefusedByEveryCall) {
  BodySet bodies = emptySet();
  bodies.add({{ballAt(Vec3::Zero())}});
  bodies.remove(bodies.add({{ballAt(Vec3::Zero())}}), "test");
  for (const std::function<void()>& call : std::vector<std::function<void()>>{
           [&] { bodies.remove(1, "caller"); },
           [&] { bodies.body(1, "caller"); },
           [&] { bodies.setPose(1, {}, "caller"); },
           [&] { bodies.setBend(1, {}, "caller"); },
           [&] { bodies.pose(1, {}, "caller"); },
           [&] { bodies.bend(1, "caller"); },
       })
    EXPECT_EQ(errorOf(call), "unknown body 1: caller; it was never added, or was removed");
  EXPECT_EQ(bodies.ids(), std::vector<BodyId>{0});
}

TEST(BodySet, WhatABodyCannotDoIsRefused) {
  BodySet bodies = emptySet();
  bodies.add({.primitives = {ballAt(Vec3::Zero())}, .follows_head = true});
  bodies.add({.primitives = {fieldBall(Vec3::Zero())}, .bends = true});
  EXPECT_EQ(errorOf([&] { bodies.setPose(0, {}, "caller"); }),
            "body 0 follows the head: caller; move the head, or add the body without follows_head");
  EXPECT_EQ(errorOf([&] { bodies.setBend(0, {}, "caller"); }),
            "body 0 does not bend: caller; add it with RigidBody::bends");
  const float nan = std::numeric_limits<float>::quiet_NaN();
  SurfaceBend bend;
  bend.terms[3].y() = nan;
  EXPECT_EQ(errorOf([&] { bodies.setBend(1, bend, "caller"); }),
            "a bend is not finite: caller; check its terms and middle");
  EXPECT_NE(errorOf([&] { bodies.setPose(1, poseAt(Vec3(0, nan, 0)), "caller"); }).find("caller"),
            std::string::npos);
  EXPECT_EQ(bodies.pose(1, {}, "test").position, Vec3(Vec3::Zero()));
}

TEST(BodySet, BadBodiesAreFound) {
  EXPECT_EQ(errorOf([] { checkBody({{ballAt(Vec3::Zero()), fieldBall(Vec3::Zero())}}, "caller"); }), "");
  EXPECT_EQ(errorOf([] { checkBody({{ballAt(Vec3::Zero(), 0)}}, "caller"); }),
            "a body has no size: caller; give a radius above 0");
  RigidBody nowhere{.primitives = {ballAt(Vec3::Zero())}};
  nowhere.pose.position.x() = std::numeric_limits<float>::infinity();
  EXPECT_NE(errorOf([&] { checkBody(nowhere, "caller"); }).find("caller"), std::string::npos);
  nowhere.follows_head = true;
  EXPECT_EQ(errorOf([&] { checkBody(nowhere, "caller"); }), "") << "its pose is unused";
  RigidBody rotated{.primitives = {fieldBall(Vec3::Zero())}};
  rotated.primitives[0].rotation = poseAt(Vec3::Zero(), 0.1f).rotation;
  EXPECT_EQ(errorOf([&] { checkBody(rotated, "caller"); }), "");
  rotated.bends = true;
  EXPECT_EQ(errorOf([&] { checkBody(rotated, "caller"); }),
            "a distance field that bends is rotated within its body: caller; rotate the body instead");
}

TEST(BodySet, PrimitivesMoveFromTheStartToTheEndRelativeToTheOrigin) {
  BodySet bodies = emptySet();
  const ContactPrimitive one = ballAt(Vec3(0.1f, 0, 0)), two = ballAt(Vec3(0, 0.2f, 0), 0.3f);
  bodies.add({.primitives = {one, two}, .follows_head = true, .pose = poseAt(Vec3(7, 7, 7))});
  const Pose first = poseAt(Vec3(20, 1, 0), 0.2f), second = poseAt(Vec3(20, 1.25f, 0), 0.4f);
  const BodyId free = bodies.add({.primitives = {two}, .pose = first});
  const Pose head_begin = poseAt(Vec3(21, 0, 0)), head_end = poseAt(Vec3(21, 0, 0.5f), -0.1f);
  const Origin origin{Vec3(21, 0, 0)};
  const auto expectMotion = [&](const Pose& begin, const Pose& end) {
    bodies.place(head_begin, head_end, origin, kTimeStep);
    ASSERT_EQ(bodies.primitives().size(), 3u);
    const Pose local = origin.toLocal(head_begin), local_end = origin.toLocal(head_end);
    EXPECT_TRUE(sameBits(bodies.primitives()[0], moved(one, local, local_end, kTimeStep)));
    EXPECT_TRUE(sameBits(bodies.primitives()[1], moved(two, local, local_end, kTimeStep)));
    EXPECT_TRUE(
        sameBits(bodies.primitives()[2], moved(two, origin.toLocal(begin), origin.toLocal(end), kTimeStep)));
    EXPECT_EQ(bodies.pose(free, head_begin, "test").position, begin.position);
    EXPECT_EQ(bodies.pose(0, head_begin, "test").position, head_begin.position);
  };
  expectMotion(first, first);
  bodies.setPose(free, second, "test");
  expectMotion(first, second);
  bodies.cancelMotion();
  expectMotion(first, first);
  bodies.setPose(free, second, "test");
  bodies.advance();
  expectMotion(second, second);
}

TEST(BodySet, ASimulationGivesItsBackendTheSamePrimitivesAndLists) {
  const StrandModel model = awkwardModel(150, 3);
  const std::vector<RigidBody> list = {
      {.primitives = {ballAt(Vec3(0, -0.1f, 0))}, .follows_head = true, .holds_roots = true},
      {.primitives = {fieldBall(Vec3::Zero()), ballAt(Vec3(0, 0.3f, 0))},
       .pose = poseAt(Vec3(0.1f, 0, 0)),
       .bends = true},
      {.primitives = {ballAt(Vec3(9, 0, 0))}}};
  Parameters parameters;
  parameters.solver = SolverKind::kRod;
  Simulation simulation(model, list, parameters, makeReferenceBackend());
  const StrandReach reach(model, strandOrder(model), strandLengths(model));
  std::vector<Box> boxes(reach.neighbourhoods());
  BodySet bodies = emptySet(boxes.size());
  for (const RigidBody& body : list) bodies.add(body);
  EXPECT_EQ(bodies.restDistances(model, parameters.hair_radius), simulation.model().rest_distance);
  Pose head;
  for (int i = 1; i <= 3; ++i) {
    const Pose begin = head, pose = poseAt(Vec3(0.1f, 0.01f * static_cast<float>(i), 0), 0.1f);
    head = poseAt(Vec3(0, 0, 0.01f * static_cast<float>(i)), 0.05f);
    SurfaceBend bend;
    bend.terms[0].y() = 0.002f * static_cast<float>(i);
    simulation.setHeadPose(head);
    simulation.setBodyPose(1, pose);
    simulation.setBodyBend(1, bend);
    bodies.setPose(1, pose, "test");
    bodies.setBend(1, bend, "test");

    const StepInput input = simulation.nextInput();
    bodies.place(begin, head, {}, parameters.time_step);
    ASSERT_EQ(input.primitives.size(), bodies.primitives().size());
    for (size_t p = 0; p < input.primitives.size(); ++p)
      EXPECT_TRUE(sameBits(input.primitives[p], bodies.primitives()[p])) << p;
    EXPECT_EQ(input.shapes->words, bodies.shapes().words);
    reach.place(std::vector(model.bones.size(), begin), std::vector(model.bones.size(), head),
                parameters.hair_radius + kQueryReach, boxes);
    const NearBodyLists& near = bodies.findNear(boxes);
    ASSERT_NE(input.near, nullptr);
    EXPECT_EQ(input.near->offsets, near.offsets);
    EXPECT_EQ(input.near->bodies, near.bodies);
    simulation.step();
    bodies.advance();
  }
}

TEST(BodySet, ABendIsThatOfTheStepAndRemainsUntilTheNext) {
  BodySet bodies = emptySet();
  const BodyId soft = bodies.add({.primitives = {fieldBall(Vec3::Zero())}, .bends = true});
  const auto distanceAtTop = [&] {
    bodies.place({}, {}, {}, kTimeStep);
    return signedDistance(bodies.primitives()[0], Vec3(0, 0.05f, 0), bodies.shapes().words);
  };
  EXPECT_NEAR(distanceAtTop(), 0, 5e-4);
  EXPECT_FALSE(isBent(bodies.primitives()[0]));
  SurfaceBend lowered;
  lowered.terms[0] = Vec3(0, 0.01f, 0);
  bodies.setBend(soft, lowered, "test");
  EXPECT_NEAR(distanceAtTop(), 0.01f, 1e-3);
  EXPECT_TRUE(isBent(bodies.primitives()[0]));
  EXPECT_TRUE(bodies.bend(soft, "test").isNone()) << "at the start of the step";
  bodies.cancelMotion();
  EXPECT_NEAR(distanceAtTop(), 0, 5e-4);
  bodies.setBend(soft, lowered, "test");
  bodies.advance();
  EXPECT_NEAR(distanceAtTop(), 0.01f, 1e-3);
  EXPECT_EQ(bodies.bend(soft, "test").terms[0], lowered.terms[0]);
}

TEST(BodySet, BodiesThatStayKeepTheirShapesWhenOthersGo) {
  BodySet bodies = emptySet();
  const BodyId first = bodies.add({.primitives = {fieldBall(Vec3(1, 0, 0))}, .bends = true});
  bodies.add({.primitives = {ballAt(Vec3::Zero()), fieldBall(Vec3(2, 0, 0))}});
  bodies.place({}, {}, {}, kTimeStep);
  const uint32_t data = bodies.primitives()[2].data;
  EXPECT_NE(data, 0u);
  bodies.remove(first, "test");
  bodies.place({}, {}, {}, kTimeStep);
  ASSERT_EQ(bodies.primitives().size(), 2u);
  EXPECT_EQ(bodies.primitives()[1].data, 0u) << "its data are the only ones";
  EXPECT_NEAR(signedDistance(bodies.primitives()[1], Vec3(2, 0.05f, 0), bodies.shapes().words), 0, 5e-4);
}

TEST(BodySet, NearListsAreThoseOfTheSweptPrimitives) {
  BodySet bodies = emptySet(2);
  bodies.add({.primitives = {ballAt(Vec3(-5, 0, 0)), ballAt(Vec3(5, 0, 0))}});
  const BodyId passing = bodies.add({.primitives = {ballAt(Vec3::Zero())}, .pose = poseAt(Vec3(0, 5, 0))});
  bodies.setPose(passing, poseAt(Vec3(0, -5, 0)), "test");
  bodies.place({}, {}, {}, kTimeStep);
  const Eigen::Vector3f half = Eigen::Vector3f::Constant(0.1f), side(5, 0, 0);
  const std::vector<Box> boxes = {Box(-half, half), Box(side - half, side + half)};
  const NearBodyLists& near = bodies.findNear(boxes);
  EXPECT_EQ(near.offsets, (std::vector<uint32_t>{0, 1, 2}));
  EXPECT_EQ(near.bodies, (std::vector<uint32_t>{2, 1})) << "indices of primitives";
}

TEST(BodySet, RestDistancesAreThoseToBodiesThatHoldRoots) {
  StrandSet set;
  set.append(std::vector<Vec3>{Vec3(0, 0.08f, 0), Vec3(0, 0.12f, 0), Vec3(0, 0.2f, 0)});
  const StrandModel model = makeStrandModel(set);
  BodySet bodies = emptySet();
  bodies.add({.primitives = {ballAt(Vec3(0, 0.2f, 0))}});
  EXPECT_TRUE(bodies.restDistances(model, 1e-4f).empty());
  bodies.add({.primitives = {ballAt(Vec3::Zero())}, .follows_head = true, .holds_roots = true});
  const std::vector<float> distances = bodies.restDistances(model, 1e-4f);
  ASSERT_EQ(distances.size(), 3u);
  EXPECT_NEAR(distances[0], -0.02f - kSkinDepth, 1e-5);
  EXPECT_NEAR(distances[1], 0.02f, 1e-5);
  EXPECT_NEAR(distances[2], 0.1f, 1e-5);
}

}  // namespace
}  // namespace strandcast
