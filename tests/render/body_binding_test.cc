// A body whose parts are colliders is drawn where they are.
#include "render/body_binding.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "collision/field_bake.h"
#include "tests/collision/shapes.h"

namespace strandcast {
namespace {

HairObstacle ballAt(const Vec3& middle, uint32_t collider) {
  HairObstacle ball;
  ball.shape.kind = PrimitiveKind::kField;
  FieldOptions options;
  options.cell = 2e-3f;
  ball.shape.field =
      std::make_shared<DistanceField>(FieldBaker(shapes::sphere(0.03f, 3, middle), options).bake());
  ball.follows_head = false;
  ball.collider = collider;
  return ball;
}

TEST(BodyBinding, VerticesMoveWithTheCollidersOnWhoseSurfacesTheyLie) {
  const Vec3 left(-0.02f, 0, 0), right(0.02f, 0, 0);  // the balls meet in a circle about x = 0
  const float meet = std::sqrt(0.03f * 0.03f - 0.02f * 0.02f);
  const std::vector<Vec3> rest{Vec3(-0.05f, 0, 0), Vec3(0.05f, 0, 0), Vec3(0, meet, 0), Vec3(0, 1, 0)};
  BodyBinding binding(rest, std::vector<HairObstacle>{ballAt(left, 7), ballAt(right, 9)});
  for (size_t v = 0; v < 3; ++v) {
    ASSERT_TRUE(binding.holds(v));
    EXPECT_LT((binding.position(v, rest[v]) - rest[v]).norm(), 1e-7f);
  }
  EXPECT_FALSE(binding.holds(3)) << "far from both";
  const Quat turn(Eigen::AngleAxisf(0.5f, Eigen::Vector3f::UnitZ()));
  binding.place(std::vector<PlacedCollider>{{9, {Vec3(0, 0.1f, 0), turn}}, {3, {Vec3(5, 5, 5), turn}}});
  EXPECT_LT((binding.position(0, rest[0]) - rest[0]).norm(), 1e-7f);
  EXPECT_LT((binding.position(1, rest[1]) - (turn * rest[1] + Vec3(0, 0.1f, 0))).norm(), 1e-6f);
  EXPECT_LT((binding.direction(1, Vec3::UnitX()) - turn * Vec3::UnitX()).norm(), 1e-6f);
  const Vec3 between = 0.5f * (rest[2] + turn * rest[2] + Vec3(0, 0.1f, 0));
  EXPECT_LT((binding.position(2, rest[2]) - between).norm(), 0.02f) << "near the mean of both";
  EXPECT_GT((binding.position(2, rest[2]) - rest[2]).norm(), 0.02f);
}

TEST(BodyBinding, WhatFollowsTheHeadOrIsNoColliderCarriesNothing) {
  HairObstacle head = ballAt(Vec3::Zero(), 1);
  head.follows_head = true;
  const std::vector<Vec3> rest{Vec3(0.03f, 0, 0)};
  EXPECT_TRUE(BodyBinding(rest, std::vector<HairObstacle>{head, ballAt(Vec3::Zero(), kNoCollider)}).empty());
  EXPECT_FALSE(BodyBinding().holds(0));
}

}  // namespace
}  // namespace strandcast
