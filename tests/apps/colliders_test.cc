// A daemon's colliders, over the channel within one process.
#include "tests/apps/daemon_fixture.h"
#include "transport/collider_chunks.h"
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
  cast(14);  // a quarter of a second, with the frame of the command
  EXPECT_NEAR(place(), 0.4, 0.01);
  cast(30);
  EXPECT_FLOAT_EQ(place(), 0.3f) << "and stays";
  EXPECT_EQ(subscriber_->colliders(), with) << "motion is no new description";
  EXPECT_EQ(order(CommandKind::kRemoveCollider, "ball"), "");
  EXPECT_EQ(subscriber_->colliders()->colliders.size(), scene_bodies_);
  EXPECT_EQ(place(), -1);
  EXPECT_NE(order(CommandKind::kRemoveCollider, "ball"), "") << "it is gone";
}

TEST_F(DaemonColliders, AreToldByTheirNames) {
  EXPECT_EQ(order(CommandKind::kAddCollider, "a ball 100 % round", ball(0.5)), "");
  const NamedValues told = toldOf(subscriber_->status()->parameters, kToldCollider);
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(told[0].first, "a ball 100 % round");
  EXPECT_EQ(told[0].second[0], subscriber_->colliders()->colliders.back().id);
  EXPECT_EQ(order(CommandKind::kRemoveCollider, "a ball 100 % round"), "");
  EXPECT_TRUE(toldOf(subscriber_->status()->parameters, kToldCollider).empty());
}

TEST_F(DaemonColliders, KeepHairOut) {
  cast(1);
  // Slowly to where the tip hangs that is farthest from the head.
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
  EXPECT_NE(order(CommandKind::kAddCollider, "ball", ball(0.5)).find("name of its own"), std::string::npos);
  EXPECT_NE(order(CommandKind::kMoveCollider, "ball", {0, 0, 0, 0, 0, 0, 1}).find("follows the head"),
            std::string::npos);
  EXPECT_NE(order(CommandKind::kMoveCollider, "cube", {0, 0, 0, 0, 0, 0, 1}), "");
  EXPECT_NE(order(CommandKind::kAddCollider, "short", {0, 0, 1}), "");
  std::vector<double> field = ball(0.5), nowhere = ball(0.5), flat = ball(0.5), nameless = ball(0.5),
                      point = ball(0.5);
  field[0] = 7;
  nowhere[8] = 0;    // no rotation
  flat[0] = 5;       // a box without extent
  point[9 + 6] = 0;  // a ball without a radius
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

TEST_F(DaemonColliders, OneThatIsRefusedChangesNothing) {
  std::vector<double> vast = ball(0.5);
  vast[9 + 6] = 2e7;  // m, its radius
  EXPECT_NE(order(CommandKind::kAddCollider, "vast", vast).find("10 km"), std::string::npos);
  EXPECT_NE(order(CommandKind::kRemoveCollider, "vast").find("there is no collider"), std::string::npos);
  EXPECT_EQ(order(CommandKind::kAddCollider, "ball", ball(0.5)), "");
  EXPECT_EQ(subscriber_->colliders()->colliders.size(), scene_bodies_ + 1);
  EXPECT_EQ(order(CommandKind::kRemoveCollider, "ball"), "");
  EXPECT_EQ(subscriber_->colliders()->colliders.size(), scene_bodies_);
}

}  // namespace
}  // namespace strandcast
