// A daemon's colliders, over the in-process channel.
#include <fstream>

#include "io/file_bytes.h"
#include "tests/apps/daemon_fixture.h"
#include "tests/expect_error.h"
#include "tests/io/scratch_folder.h"
#include "tests/io/skinned_arm.h"
#include "transport/chunks.h"
#include "transport/parameter_table.h"

namespace strandcast {
namespace {

class DaemonColliders : public DaemonFixture {
 protected:
  void SetUp() override {
    Settings settings = fewStrands();
    settings.scene.body_contact = BodyContact::kSpheres;
    static const Scene scene = makeScene(settings.scene);
    scene_bodies_ = scene.bodies.size();
    start(settings, scene);
  }
  std::string order(CommandKind kind, const std::string& name, std::vector<double> values = {}) {
    return DaemonFixture::order(kind, std::move(values), name);
  }
  static std::vector<double> ball(double z, bool follows_head = false) {
    ContactPrimitive shape;
    shape.radius = 0.04f;
    std::vector<double> values = {0, follows_head ? 1.0 : 0.0, 0, 0, z, 0, 0, 0, 1};
    shapeNumbers(shape, [&](float n) { values.push_back(static_cast<double>(n)); });
    return values;
  }

  size_t scene_bodies_ = 0;
};

TEST_F(DaemonColliders, ThoseOfTheSceneAreCast) {
  const auto colliders = subscriber_->colliders();
  ASSERT_TRUE(colliders);
  ASSERT_GT(scene_bodies_, 0u);
  EXPECT_EQ(colliders->colliders.size(), scene_bodies_);
  for (const Collider& collider : colliders->colliders) EXPECT_FALSE(collider.shapes.empty());
}

TEST_F(DaemonColliders, AreAddedMovedAndRemovedByCommand) {
  EXPECT_EQ(order(CommandKind::kAddCollider, "ball", ball(0.5)), "");
  const auto with = subscriber_->colliders();
  ASSERT_EQ(with->colliders.size(), scene_bodies_ + 1);
  const Collider& added = with->colliders.back();
  EXPECT_FALSE(added.follows_head);
  EXPECT_EQ(added.shapes[0].radius, 0.04f);
  const auto place = [&] {
    for (const PlacedCollider& placed : subscriber_->frame()->colliders)
      if (placed.id == added.id) return placed.pose.position.z();
    return -1.0f;
  };
  EXPECT_FLOAT_EQ(place(), 0.5f);
  EXPECT_EQ(order(CommandKind::kMoveCollider, "ball", {0, 0, 0.3, 0, 0, 0, 1, 0.5}), "");
  cast(14);  // a quarter of a second, including the frame of the command
  EXPECT_NEAR(place(), 0.4, 0.01);
  cast(30);
  EXPECT_FLOAT_EQ(place(), 0.3f) << "and stays";
  EXPECT_EQ(subscriber_->colliders(), with) << "motion is no new description";
  EXPECT_EQ(order(CommandKind::kRemoveCollider, "ball"), "");
  EXPECT_EQ(subscriber_->colliders()->colliders.size(), scene_bodies_);
  EXPECT_EQ(place(), -1);
  EXPECT_NE(order(CommandKind::kRemoveCollider, "ball"), "") << "it is gone";
}

TEST_F(DaemonColliders, AreReportedByTheirNames) {
  EXPECT_EQ(order(CommandKind::kAddCollider, "a ball 100 % round", ball(0.5)), "");
  const NamedValues told = entriesOf(subscriber_->status()->parameters, kColliderEntry);
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(told[0].first, "a ball 100 % round");
  EXPECT_EQ(told[0].second[0], subscriber_->colliders()->colliders.back().id);
  EXPECT_EQ(order(CommandKind::kRemoveCollider, "a ball 100 % round"), "");
  EXPECT_TRUE(entriesOf(subscriber_->status()->parameters, kColliderEntry).empty());
}

TEST_F(DaemonColliders, KeepHairOut) {
  cast(1);
  // Moves slowly to the position of the tip farthest from the head.
  const auto before = subscriber_->frame();
  size_t tip = 0;
  for (size_t v = 0; v < before->positions.size(); ++v)
    if (before->positions[v].norm() > before->positions[tip].norm()) tip = v;
  const Vec3 at = before->positions[tip];
  std::vector<double> values = ball(0);
  for (size_t c = 0; c < 3; ++c) values[2 + c] = static_cast<double>(3 * at[static_cast<int>(c)]);
  EXPECT_EQ(order(CommandKind::kAddCollider, "ball", values), "");
  cast(10);
  EXPECT_LT((subscriber_->frame()->positions[tip] - at).norm(), 0.01f);
  EXPECT_EQ(order(CommandKind::kMoveCollider, "ball",
                  {static_cast<double>(at.x()), static_cast<double>(at.y()), static_cast<double>(at.z()), 0,
                   0, 0, 1, 0.5}),
            "");
  cast(60);
  EXPECT_GT((subscriber_->frame()->positions[tip] - at).norm(), 0.038f);
}

TEST_F(DaemonColliders, BadCommandsAreRefused) {
  EXPECT_EQ(order(CommandKind::kAddCollider, "ball", ball(0.5, true)), "");
  EXPECT_NE(order(CommandKind::kAddCollider, "ball", ball(0.5)).find("unique name"), std::string::npos);
  EXPECT_NE(order(CommandKind::kMoveCollider, "ball", {0, 0, 0, 0, 0, 0, 1}).find("follows the head"),
            std::string::npos);
  EXPECT_NE(order(CommandKind::kMoveCollider, "cube", {0, 0, 0, 0, 0, 0, 1}), "");
  EXPECT_NE(order(CommandKind::kAddCollider, "short", {0, 0, 1}), "");
  std::vector<double> field = ball(0.5), nowhere = ball(0.5), flat = ball(0.5), nameless = ball(0.5),
                      point = ball(0.5);
  field[0] = 7;
  nowhere[8] = 0;    // zero quaternion
  flat[0] = 5;       // a box without extent
  point[9 + 6] = 0;  // sphere of radius 0
  for (const auto& bad : {field, nowhere, flat, point})
    EXPECT_NE(order(CommandKind::kAddCollider, "bad", bad), "");
  EXPECT_NE(order(CommandKind::kAddCollider, "", nameless), "");
  EXPECT_EQ(subscriber_->colliders()->colliders.size(), scene_bodies_ + 1);
  size_t taken = 0;
  while (taken <= kMaxPlacedColliders &&
         order(CommandKind::kAddCollider, "n" + std::to_string(taken), ball(5)).empty())
    ++taken;
  EXPECT_GE(taken, kMaxPlacedColliders - scene_bodies_);
  EXPECT_LE(taken, kMaxPlacedColliders) << "as many as a frame has room for";
}

TEST_F(DaemonColliders, ThoseThatTheSceneNamesAreMovedAndRemoved) {
  Settings settings = fewStrands();
  settings.scene.body_contact = BodyContact::kSpheres;
  ScenePrimitive stone, hat;
  stone.shape.radius = hat.shape.radius = 0.04f;
  stone.shape.a = Vec3(0, 0, 0.5f);
  stone.follows_head = false;
  stone.name = "a stone";
  hat.shape.a = Vec3(0, 1, 0);
  hat.name = "hat";
  settings.scene.primitives = {stone, hat};
  settings.scene.body_name = "bust";
  start(settings, makeScene(settings.scene));
  cast(1);
  const std::vector<Collider> all = subscriber_->colliders()->colliders;
  ASSERT_EQ(all.size(), scene_bodies_ + 2);
  const uint32_t id = all[scene_bodies_].id;
  const NamedValues told = entriesOf(daemon_->status().parameters, kColliderEntry);
  ASSERT_EQ(told, (NamedValues{{"bust", {0, static_cast<double>(scene_bodies_)}},
                               {"a stone", {static_cast<double>(id)}},
                               {"hat", {static_cast<double>(all[scene_bodies_ + 1].id)}}}));
  const auto place = [&] {
    for (const PlacedCollider& placed : subscriber_->frame()->colliders)
      if (placed.id == id) return placed.pose.apply(all[scene_bodies_].shapes[0].a);
    return Vec3(-1, -1, -1);
  };
  EXPECT_EQ(place(), Vec3(0, 0, 0.5f));
  EXPECT_EQ(order(CommandKind::kMoveCollider, "a stone", {0.1, 0, 0.3, 0, 0, 0, 1, 0}), "");
  EXPECT_EQ(place(), Vec3(0.1f, 0, 0.3f)) << "its middle is where it is told to be";
  EXPECT_NE(order(CommandKind::kMoveCollider, "hat", {0, 0, 0, 0, 0, 0, 1}).find("follows the head"),
            std::string::npos);
  EXPECT_NE(order(CommandKind::kAddCollider, "hat", ball(0.5)).find("unique name"), std::string::npos);
  EXPECT_NE(order(CommandKind::kAddCollider, "bust", ball(0.5)).find("unique name"), std::string::npos);
  for (const CommandKind kind : {CommandKind::kMoveCollider, CommandKind::kRemoveCollider})
    EXPECT_NE(order(kind, "bust", {0, 0, 0, 0, 0, 0, 1}).find("hair grows on 'bust'"), std::string::npos);
  EXPECT_EQ(order(CommandKind::kRemoveCollider, "hat"), "");
  EXPECT_EQ(order(CommandKind::kRemoveCollider, "a stone"), "");
  EXPECT_EQ(subscriber_->colliders()->colliders.size(), scene_bodies_);
  EXPECT_EQ(order(CommandKind::kAddCollider, "hat", ball(0.5)), "");
}

TEST_F(DaemonColliders, OnesThatHangOnJointsGoWithThemAndCanOnlyBeRemoved) {
  const ScratchFolder folder;
  samples::ArmOptions arm = samples::smallArm();
  arm.joints = {"neck", "head"};
  writeFileBytes(folder / "arm.glb", samples::armGlb(arm));
  std::ofstream(folder / "hair.obj") << "v 0.04 0.2 0\nv 0.06 0.2 0\nv 0.08 0.2 0\nl 1 2 3\n";
  Settings settings = fewStrands();
  settings.scene = {};
  settings.scene.groom = {folder / "hair.obj"};
  settings.scene.body = folder / "arm.glb";
  settings.scene.units = {1, UpAxis::kY};
  settings.scene.skinned = SkinnedMotion{"bend", "neck"};
  settings.scene.body_cell = 0.01f;
  ScenePrimitive crown;
  crown.shape.a = Vec3(0, 0.4f, 0);
  crown.shape.radius = 0.02f;
  crown.joint = "head";
  crown.name = "crown";
  settings.scene.primitives = {crown};
  settings.scene.body_name = "walker";
  start(settings, makeScene(settings.scene));
  cast(1);
  const Collider worn = subscriber_->colliders()->colliders.back();
  const auto place = [&] {
    const PlacedCollider& last = subscriber_->frame()->colliders.back();
    EXPECT_EQ(last.id, worn.id);
    return last.pose.apply(worn.shapes[0].a);
  };
  EXPECT_LT((place() - crown.shape.a).norm(), 0.01f) << "the clip begins at rest";
  cast(60);
  EXPECT_GT((place() - crown.shape.a).norm(), 0.05f) << "and turns the head";
  EXPECT_GT((subscriber_->frame()->positions[0] - Vec3(0.04f, 0.2f, 0)).norm(), 5e-3f)
      << "hair on the neck stays on its skin, which the head takes along";
  const std::string told = order(CommandKind::kMoveCollider, "crown", {0, 0, 0, 0, 0, 0, 1});
  EXPECT_NE(told.find("follows the body's joint 'head'"), std::string::npos) << told;
  EXPECT_NE(order(CommandKind::kMoveCollider, "walker", {0, 0, 0, 0, 0, 0, 1}).find("move its joints"),
            std::string::npos);
  const size_t with = subscriber_->colliders()->colliders.size();
  EXPECT_EQ(order(CommandKind::kRemoveCollider, "crown"), "");
  cast(2);
  EXPECT_EQ(subscriber_->colliders()->colliders.size(), with - 1);
}

TEST_F(DaemonColliders, MoreThanAFrameTellsOfAreRefusedBeforeTheFirst) {
  Settings settings = fewStrands();
  settings.scene.body_contact = BodyContact::kSpheres;
  for (size_t i = 0; i <= kMaxPlacedColliders; ++i) {
    ScenePrimitive ball;
    ball.shape.radius = 0.01f;
    ball.shape.a = Vec3(0, 5, 0);
    ball.follows_head = false;
    ball.name = std::to_string(i);
    settings.scene.primitives.push_back(std::move(ball));
  }
  const std::string told = errorOf([&] { start(settings, makeScene(settings.scene)); });
  EXPECT_NE(told.find("bodies do not follow the head"), std::string::npos) << told;
}

TEST_F(DaemonColliders, OneThatIsRefusedChangesNothing) {
  std::vector<double> vast = ball(0.5);
  vast[9 + 6] = 2e7;  // radius, m
  EXPECT_NE(order(CommandKind::kAddCollider, "vast", vast).find("10 km"), std::string::npos);
  EXPECT_NE(order(CommandKind::kRemoveCollider, "vast").find("unknown collider"), std::string::npos);
  EXPECT_EQ(order(CommandKind::kAddCollider, "ball", ball(0.5)), "");
  EXPECT_EQ(subscriber_->colliders()->colliders.size(), scene_bodies_ + 1);
  EXPECT_EQ(order(CommandKind::kRemoveCollider, "ball"), "");
  EXPECT_EQ(subscriber_->colliders()->colliders.size(), scene_bodies_);
}

}  // namespace
}  // namespace strandcast
