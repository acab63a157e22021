// A body whose parts are colliders is drawn at their poses.
#include "transport/body_binding.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <memory>

#include "collision/field_bake.h"
#include "collision/skin_parts.h"
#include "render/hair_bodies.h"
#include "tests/collision/shapes.h"
#include "tests/io/skinned_arm.h"

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
  const Vec3 left(-0.02f, 0, 0), right(0.02f, 0, 0);  // the balls intersect in a circle around x = 0
  const float meet = std::sqrt(0.03f * 0.03f - 0.02f * 0.02f);
  const std::vector<Vec3> rest{Vec3(-0.05f, 0, 0), Vec3(0.05f, 0, 0), Vec3(0, meet, 0), Vec3(0, 1, 0)};
  BodyBinding binding(rest, bodyParts(std::vector<HairObstacle>{ballAt(left, 7), ballAt(right, 9)}));
  for (size_t v = 0; v < 3; ++v) {
    ASSERT_TRUE(binding.holds(v));
    EXPECT_LT((binding.position(v, rest[v]) - rest[v]).norm(), 1e-7f);
  }
  EXPECT_FALSE(binding.holds(3)) << "far from both";
  const Quat turn(Eigen::AngleAxisf(0.5f, Eigen::Vector3f::UnitZ()));
  binding.setColliderPoses(
      std::vector<PlacedCollider>{{9, {Vec3(0, 0.1f, 0), turn}, {}}, {3, {Vec3(5, 5, 5), turn}, {}}});
  EXPECT_LT((binding.position(0, rest[0]) - rest[0]).norm(), 1e-7f);
  EXPECT_LT((binding.position(1, rest[1]) - (turn * rest[1] + Vec3(0, 0.1f, 0))).norm(), 1e-6f);
  EXPECT_LT((binding.normal(1, rest[1], Vec3::UnitX()) - turn * Vec3::UnitX()).norm(), 1e-6f);
  const Vec3 between = 0.5f * (rest[2] + turn * rest[2] + Vec3(0, 0.1f, 0));
  EXPECT_LT((binding.position(2, rest[2]) - between).norm(), 0.02f) << "near the mean of both";
  EXPECT_GT((binding.position(2, rest[2]) - rest[2]).norm(), 0.02f);
}

TEST(BodyBinding, VerticesGoWhereABendTakesThem) {
  const std::vector<Vec3> rest{Vec3(0.03f, 0, 0)};
  BodyBinding binding(rest, bodyParts(std::vector<HairObstacle>{ballAt(Vec3::Zero(), 4)}));
  PlacedCollider bent{4, {Vec3(0, 1, 0), Quat::Identity()}, {}};
  // The point at p was 0.1 p.x lower at rest: a shear, which tilts the normal of the ball's side backwards.
  bent.bend.terms[1] = Vec3(0, -0.1f, 0);
  binding.setColliderPoses(std::vector<PlacedCollider>{bent});
  EXPECT_LT((binding.position(0, rest[0]) - Vec3(0.03f, 1.003f, 0)).norm(), 1e-6f);
  EXPECT_LT((binding.normal(0, rest[0], Vec3::UnitX()) - Vec3(1, 0, 0)).norm(), 1e-6f);
  EXPECT_LT((binding.normal(0, rest[0], Vec3::UnitY()) - Vec3(-0.1f, 1, 0).normalized()).norm(), 1e-6f);
}

// On the inside of a sharp bend the skin is compressed, and fixed-point iteration for the inverse does not
// converge.
TEST(BodyBinding, PressedSkinIsDrawnWhereItIs) {
  const std::vector<Vec3> rest{Vec3(0.03f, 0, 0)};
  BodyBinding binding(rest, bodyParts(std::vector<HairObstacle>{ballAt(Vec3::Zero(), 4)}));
  PlacedCollider pressed{4, {Vec3::Zero(), Quat::Identity()}, {}};
  pressed.bend.terms[1] = Vec3(3, 0, 0);  // compression to a quarter
  pressed.bend.terms[4] = Vec3(0, 2, 0);  // points at y = 0 moved to -2 x^2
  binding.setColliderPoses(std::vector<PlacedCollider>{pressed});
  EXPECT_LT((binding.position(0, rest[0]) - Vec3(0.0075f, -2 * 0.0075f * 0.0075f, 0)).norm(), 2e-6f);
  // Where the bend has no inverse, the vertex is drawn at the nearest reachable position.
  pressed.bend.terms[1] = Vec3::Zero();
  pressed.bend.terms[4] = Vec3(20, 0, 0);  // no rest point maps to x < -1 / 80
  const std::vector<Vec3> beyond{Vec3(-0.03f, 0, 0)};
  BodyBinding folded(beyond, bodyParts(std::vector<HairObstacle>{ballAt(Vec3::Zero(), 4)}));
  folded.setColliderPoses(std::vector<PlacedCollider>{pressed});
  EXPECT_LT((folded.position(0, beyond[0]) - Vec3(-0.025f, 0, 0)).norm(), 3e-3f);
}

/// Distance between an arm's blended skin and its drawn position, m: mean and maximum over vertices.
struct Off {
  double mean = 0, most = 0;
};
Off offTheBlendedSkin(bool with_bends) {
  const SkinnedMesh skin = readGltfSkin(samples::armGlb(), "arm.glb");
  std::vector<JointTransform> locals = skin.skeleton.rest();
  skin.clips.at(0).pose(1, locals);  // bent by 60 degrees
  const std::vector<Placement> world = skin.skeleton.worldTransforms(locals),
                               bindings = skin.bindingsAt(world);
  std::vector<HairObstacle> obstacles;
  std::vector<PlacedCollider> placed;
  for (const SkinPart& part : cutSkin(skin)) {
    const auto id = static_cast<uint32_t>(placed.size());
    FieldOptions options;
    options.cell = 3e-3f;
    HairObstacle& obstacle = obstacles.emplace_back();
    obstacle.shape.kind = PrimitiveKind::kField;
    obstacle.shape.field = std::make_shared<DistanceField>(FieldBaker(part.mesh, options).bake());
    obstacle.follows_head = false;
    obstacle.collider = id;
    const Pose pose = partPose(part, bindings);
    placed.push_back({id, pose, with_bends ? partBend(part, bindings, pose) : SurfaceBend()});
  }
  BodyBinding binding(skin.mesh.positions, bodyParts(obstacles));
  binding.setColliderPoses(placed);
  const std::vector<Vec3> blended = skin.blended(world);
  Off off;
  for (size_t v = 0; v < blended.size(); ++v) {
    EXPECT_TRUE(binding.holds(v));
    const auto way = static_cast<double>((binding.position(v, skin.mesh.positions[v]) - blended[v]).norm());
    off.mean += way / static_cast<double>(blended.size());
    off.most = std::max(off.most, way);
  }
  std::printf(
      "an arm bent by 60 degrees, drawn %s bends: %.2f mm off its blended skin in the mean, %.1f at most\n",
      with_bends ? "with" : "without", 1e3 * off.mean, 1e3 * off.most);
  return off;
}

// docs/architecture.md, "Skinned bodies", quotes these numbers.
TEST(BodyBinding, ASkinIsDrawnNearToWhereItIsBlended) {
  const Off rigid = offTheBlendedSkin(false), bent = offTheBlendedSkin(true);
  EXPECT_LT(bent.mean, 0.4 * rigid.mean);
  EXPECT_LT(bent.most, 0.6 * rigid.most);
}

TEST(BodyBinding, WhatFollowsTheHeadOrIsNoColliderCarriesNothing) {
  HairObstacle head = ballAt(Vec3::Zero(), 1);
  head.follows_head = true;
  const std::vector<Vec3> rest{Vec3(0.03f, 0, 0)};
  EXPECT_TRUE(BodyBinding(rest, bodyParts(std::vector<HairObstacle>{head, ballAt(Vec3::Zero(), kNoCollider)}))
                  .empty());
  HairObstacle aside = ballAt(Vec3(0, 16, 0), 2);
  aside.shape.a = Vec3(0, -16, 0);  // so that it also surrounds the vertex
  EXPECT_TRUE(BodyBinding(rest, bodyParts(std::vector<HairObstacle>{aside})).empty());
  EXPECT_FALSE(BodyBinding().holds(0));
}

}  // namespace
}  // namespace strandcast
