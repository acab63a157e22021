// The daemon's loop over the in-process channel.
#include "apps/daemon.h"

#include <gtest/gtest.h>

#include "scenes/scene.h"
#include "transport/in_process.h"

namespace strandcast {
namespace {

class DaemonTest : public ::testing::Test {
 protected:
  void SetUp() override {
    Settings settings;
    settings.scene.name = "straight";
    settings.scene.strands = 20;
    settings.scene.vertices = 8;
    settings.scene.motion = "still";
    settings.backend = "reference";
    std::tie(publisher_, subscriber_) = makeInProcessChannel(settings.groom_id);
    daemon_ = std::make_unique<Daemon>(settings, makeScene(settings.scene), *publisher_, newSession());
    daemon_->announce();
  }

  /// The daemon's answer.
  std::string order(CommandKind kind, std::vector<double> values, const std::string& name = "") {
    Command command;
    command.id = ++id_;
    command.kind = kind;
    command.name = name;
    command.values = std::move(values);
    subscriber_->send(command);
    daemon_->castFrame(stop_);
    return subscriber_->waitForAnswer(command.id, std::chrono::milliseconds(1000)).value_or("no answer");
  }
  double seconds() const { return subscriber_->frame()->simulation_time; }

  std::unique_ptr<Publisher> publisher_;
  std::unique_ptr<Subscriber> subscriber_;
  std::unique_ptr<Daemon> daemon_;
  std::atomic<bool> stop_{false};
  uint64_t id_ = 0;
};

TEST_F(DaemonTest, HoldsStillWhilePausedAndTakesSingleSteps) {
  EXPECT_NE(order(CommandKind::kStep, {1}).find("pause it first"), std::string::npos);
  EXPECT_EQ(order(CommandKind::kPause, {1}), "");
  const double held = seconds();
  const uint64_t frame = subscriber_->frame()->frame;
  for (int i = 0; i < 5; ++i) daemon_->castFrame(stop_);
  EXPECT_EQ(seconds(), held);
  EXPECT_EQ(subscriber_->frame()->frame, frame + 5) << "who comes late still gets frames";
  EXPECT_EQ(order(CommandKind::kStep, {3}), "");
  EXPECT_NEAR(seconds(), held + 3.0 / 60, 1e-6);
  EXPECT_NE(order(CommandKind::kStep, {0.5}).find("whole number"), std::string::npos);
  EXPECT_EQ(order(CommandKind::kPause, {0}), "");
  EXPECT_GT(seconds(), held + 3.5 / 60);
}

TEST_F(DaemonTest, AHandPullsUntilItLetsGoOrNobodyMovesIt) {
  const size_t tip = 7;
  for (int i = 0; i < 10; ++i) daemon_->castFrame(stop_);
  const Vec3 rest = subscriber_->frame()->positions[tip];
  const Vec3 to = rest + Vec3(0, 0.03f, 0.05f);
  const std::vector<double> pull{rest.x(), rest.y(), rest.z(), 0.001, to.x(), to.y(), to.z(), 100};
  EXPECT_NE(order(CommandKind::kPull, {1, 2, 3}).find("8 numbers"), std::string::npos);
  EXPECT_EQ(order(CommandKind::kPull, pull), "");
  for (int i = 0; i < 50; ++i) daemon_->castFrame(stop_);
  const float held = (subscriber_->frame()->positions[tip] - rest).norm();
  EXPECT_GT(held, 0.02f);
  for (int i = 0; i < 300; ++i) daemon_->castFrame(stop_);
  EXPECT_LT((subscriber_->frame()->positions[tip] - rest).norm(), 0.3f * held) << "after a second";
  EXPECT_EQ(order(CommandKind::kPull, pull), "");
  EXPECT_EQ(order(CommandKind::kPull, {}), "");
  for (int i = 0; i < 20; ++i) daemon_->castFrame(stop_);
  EXPECT_LT((subscriber_->frame()->positions[tip] - rest).norm(), 0.3f * held);
}

TEST_F(DaemonTest, TheObserverSeesEveryFrame) {
  int seen = 0;
  daemon_->setObserver([&](Simulation& simulation) {
    ++seen;
    EXPECT_EQ(simulation.guides().size(), 160u);
  });
  for (int i = 0; i < 3; ++i) daemon_->castFrame(stop_);
  EXPECT_EQ(seen, 3);
}

}  // namespace
}  // namespace strandcast
