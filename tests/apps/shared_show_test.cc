// How daemons that share a groom hand the show on: two daemons in this process on a channel that hands shows
// over as bytes.
#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/daemon.h"
#include "apps/show_fingerprint.h"
#include "transport/parameter_table.h"
#include "transport/show.h"

namespace strandcast {
namespace {

class StageChannel;

/// Whose turn it is among the channels of a groom.
struct Stage {
  std::vector<StageChannel*> channels;
  StageChannel* casts = nullptr;
};

class StageChannel final : public Publisher {
 public:
  explicit StageChannel(Stage& stage) : stage_(stage) { stage_.channels.push_back(this); }

  GuideFrame newest;             ///< that was published
  std::deque<Command> commands;  ///< to be taken
  std::vector<Status> told;      ///< on its own turn
  bool joined = false;           ///< somebody has, and lacks the hair
  bool claims = false;           ///< has published a frame
  std::deque<std::vector<uint8_t>> shows;
  uint64_t show_session = 0;

  std::optional<Rival> rival() const override { return std::nullopt; }
  void announce(const GroomDescription&, const BodyDescription&) override {}
  void announceColliders(const ColliderSet&) override {}
  void publish(const GuideFrame& frame) override {
    newest = frame;
    claims = true;
  }
  void publishStatus(const Status& status) override {
    if (stage_.casts == this) told.push_back(status);
  }
  std::optional<Command> takeCommand() override {
    if (commands.empty()) return std::nullopt;
    const Command command = commands.front();
    commands.pop_front();
    return command;
  }
  uint32_t matchedReaders() const override { return 0; }
  EncodingReport encoding() const override { return {}; }
  SharedTurn sharedTurn() const override {
    if (stage_.casts == nullptr) return SharedTurn::kNobodys;
    return stage_.casts == this ? SharedTurn::kOwn : SharedTurn::kAnothers;
  }
  size_t sharers() const override { return stage_.channels.size() - 1; }
  bool wantsHair() const override { return joined; }
  void publishShow(const Show& show) override {
    if (show.hasHair()) joined = false;
    for (StageChannel* const other : stage_.channels)
      if (other != this) other->shows.push_back(showBytes(show));
  }
  std::optional<Show> takeShow() override {
    if (shows.empty()) return std::nullopt;
    std::optional<Show> show = showOf(shows.front());
    shows.pop_front();
    EXPECT_TRUE(show);
    if (show) show->session = 77;
    return show;
  }

 private:
  Stage& stage_;
};

Settings fewStrands() {
  Settings settings;
  settings.scene.name = "straight";
  settings.scene.strands = 6;
  settings.scene.vertices = 8;
  settings.scene.motion = "shake";
  settings.backend = "reference";
  return settings;
}

/// One of the daemons that share a groom.
struct Sharer {
  Sharer(Stage& stage, const Settings& settings) : channel(stage) {
    daemon = std::make_unique<Daemon>(settings, makeScene(settings.scene), channel, newSession());
    daemon->announce();
  }
  void cast(int frames) {
    for (int i = 0; i < frames; ++i) daemon->castFrame(stop);
  }
  double time() const { return channel.newest.simulation_time; }

  StageChannel channel;
  std::unique_ptr<Daemon> daemon;
  const std::atomic<bool> stop{false};
};

class SharedShow : public ::testing::Test {
 protected:
  void SetUp() override {
    first_ = std::make_unique<Sharer>(stage_, fewStrands());
    first_->cast(1);
    stage_.casts = &first_->channel;
  }
  /// To every daemon of the stage, as a sender's does; then a frame of the one that casts.
  std::string order(CommandKind kind, std::vector<double> values, const std::string& name = "") {
    const Command command{.id = ++id_, .kind = kind, .name = name, .values = std::move(values)};
    for (StageChannel* const channel : stage_.channels) channel->commands.push_back(command);
    first_->cast(1);
    const std::vector<Status>& told = first_->channel.told;
    return told.empty() || told.back().last_command != id_ ? "no answer" : told.back().last_command_error;
  }
  void addBall(const std::string& name, double x) {
    EXPECT_EQ(
        order(CommandKind::kAddCollider,
              {0, 0, x, 0.1, 0.7, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0.05, 0, 0.3, 0, 0, 0, 0, 0, 0, 1}, name),
        "");
  }
  /// Another one joins, and has come to where the first one is.
  std::unique_ptr<Sharer> join() {
    auto second = std::make_unique<Sharer>(stage_, fewStrands());
    first_->channel.joined = true;
    first_->cast(1);
    second->cast(1);
    EXPECT_FALSE(second->channel.claims) << "it comes to where the other one is by now";
    for (int news = 0; news < 3; ++news) {
      tell();
      second->cast(1);
    }
    EXPECT_TRUE(second->channel.claims) << "it has the show";
    return second;
  }
  /// Has the first one tell its show, which else the clock does.
  void tell() { EXPECT_EQ(order(CommandKind::kSetParameter, {0.3}, "body_friction_unknown").empty(), false); }
  /// Frames of both until they are of one time.
  void meet(Sharer& second) {
    for (int i = 0; i < 40 && std::abs(second.time() - first_->time()) > 1e-6; ++i)
      (second.time() < first_->time() ? second : *first_).cast(1);
    ASSERT_NEAR(second.time(), first_->time(), 1e-6);
  }
  static double farthest(const GuideFrame& a, const GuideFrame& b) {
    double most = 0;
    for (size_t v = 0; v < a.positions.size(); ++v)
      most = std::max(most, static_cast<double>((a.positions[v] - b.positions[v]).norm()));
    return most;
  }
  static std::optional<std::vector<double>> parameter(const Sharer& of, const std::string& name) {
    const NamedValues all = namedValues(of.daemon->status().parameters);
    for (const auto& [known, values] : all)
      if (known == name) return values;
    return std::nullopt;
  }

  Stage stage_;
  std::unique_ptr<Sharer> first_;
  uint64_t id_ = 100;
};

TEST_F(SharedShow, HairBodiesHeadAndWindOfOneThatJoinsAreThoseOfTheOneThatCasts) {
  EXPECT_EQ(order(CommandKind::kSetParameter, {7, 0, 1}, "wind"), "");
  for (int i = 0; i < 3; ++i) addBall("ball" + std::to_string(i), 0.2 * i);
  EXPECT_EQ(order(CommandKind::kMoveCollider, {0, 0.3, 0.5, 0, 0, 0, 1, 1.5}, "ball1"), "");
  EXPECT_EQ(order(CommandKind::kHeadPose, {0.02, 0.01, 0, 0, 0.1, 0, 0.995}), "");
  first_->cast(20);
  const auto second = join();
  meet(*second);
  EXPECT_LT(farthest(first_->channel.newest, second->channel.newest), 2e-6);
  EXPECT_EQ(parameter(*second, "wind"), (std::vector<double>{7, 0, 1}));
  ASSERT_EQ(second->channel.newest.colliders.size(), first_->channel.newest.colliders.size());
  for (size_t i = 0; i < second->channel.newest.colliders.size(); ++i)
    EXPECT_LT((second->channel.newest.colliders[i].pose.position -
               first_->channel.newest.colliders[i].pose.position)
                  .norm(),
              1e-6f)
        << i;
  EXPECT_LT((second->channel.newest.head.position - first_->channel.newest.head.position).norm(), 1e-6f);
  EXPECT_EQ(second->channel.newest.head.rotation.coeffs(), first_->channel.newest.head.rotation.coeffs());
  // And so they stay when the clip and the ways go on.
  first_->cast(30);
  tell();
  second->cast(1);
  meet(*second);
  EXPECT_LT(farthest(first_->channel.newest, second->channel.newest), 1e-4);
}

TEST_F(SharedShow, OneThatComesBackHasWhatItMissed) {
  addBall("gone", 0.1);
  auto second = join();
  EXPECT_EQ(order(CommandKind::kRemoveCollider, {}, "gone"), "");
  addBall("new", 0.3);
  EXPECT_EQ(order(CommandKind::kAddWindSource, {0, 0, 0.2, 0.6, 0, 0, 1, 0.2, 0.5, 0.35, 4, 0, 20}, "fan"),
            "");
  EXPECT_EQ(order(CommandKind::kMoveWindSource, {1, 2, 0.5, 0.2, 0.6}, "fan"), "");
  second->cast(1);
  ASSERT_EQ(second->daemon->windSources().size(), 1u);
  EXPECT_EQ(second->daemon->windSources()[0].name, "fan");
  ASSERT_EQ(second->channel.newest.colliders.size(), 2u) << "the scene's shoulders, and one";
  EXPECT_NEAR(second->channel.newest.colliders[1].pose.position.x(), 0.3f, 1e-6f);
  // Of another shape, under the same name.
  EXPECT_EQ(order(CommandKind::kRemoveCollider, {}, "new"), "");
  EXPECT_EQ(order(CommandKind::kRemoveWindSource, {}, "fan"), "");
  addBall("new", -0.3);
  second->cast(1);
  EXPECT_TRUE(second->daemon->windSources().empty());
  ASSERT_EQ(second->channel.newest.colliders.size(), 2u);
  EXPECT_NEAR(second->channel.newest.colliders[1].pose.position.x(), -0.3f, 1e-6f);
}

TEST_F(SharedShow, WhoTakesOverCarriesOutWhatWasNotAnsweredAndNothingTwice) {
  auto second = join();
  addBall("answered", 0.1);
  const Command last{
      .id = ++id_,
      .kind = CommandKind::kAddCollider,
      .name = "late",
      .values = {0, 0, 0.5, 0.1, 0.7, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0.05, 0, 0.3, 0, 0, 0, 0, 0, 0, 1}};
  second->channel.commands.push_back(last);  // which the one that casts never heard
  second->cast(1);
  EXPECT_TRUE(second->channel.told.empty()) << "a standby answers nobody";
  stage_.casts = nullptr;  // it is gone
  second->cast(1);
  stage_.casts = &second->channel;
  second->cast(1);
  EXPECT_EQ(second->channel.newest.colliders.size(), 3u) << "the scene's shoulders, and two";
  EXPECT_EQ(second->daemon->status().last_command, last.id);
  EXPECT_EQ(second->daemon->status().last_command_error, "");
}

TEST_F(SharedShow, WhoTakesOverRepeatsTheLastAnswers) {
  auto second = join();
  EXPECT_EQ(order(CommandKind::kSetParameter, {4, 0, 0}, "wind"), "");
  const uint64_t asked = id_;
  second->cast(1);
  stage_.casts = &second->channel;
  second->cast(1);
  EXPECT_TRUE(
      std::any_of(second->channel.told.begin(), second->channel.told.end(), [&](const Status& status) {
        return status.last_command == asked && status.last_command_error.empty();
      }));
}

TEST_F(SharedShow, PauseAndStepsThatAreLeftGoOnWithTheShow) {
  EXPECT_EQ(order(CommandKind::kPause, {1}), "");
  first_->daemon->setStepping([](const Simulation&) { return false; });
  auto second = join();
  EXPECT_EQ(order(CommandKind::kStep, {5}), "no answer") << "it takes one a frame";
  tell();
  second->cast(1);
  const double before = second->time();
  second->cast(3);
  EXPECT_EQ(second->time(), before) << "a standby takes no steps of its own";
  second->daemon->setStepping([](const Simulation&) { return false; });
  stage_.casts = &second->channel;
  second->cast(10);
  const double step = (*parameter(*second, "time_step"))[0];
  EXPECT_GT(second->time(), before);
  EXPECT_LT(second->time(), before + 5.5 * step);
  second->cast(5);
  EXPECT_LT(second->time(), before + 5.5 * step) << "and is paused again";
}

TEST_F(SharedShow, WithoutTheShowItWaits) {
  Sharer second(stage_, fewStrands());
  second.cast(10);
  EXPECT_FALSE(second.channel.claims);
  tell();
  second.cast(1);
  EXPECT_FALSE(second.channel.claims) << "without the hair";
  stage_.casts = nullptr;  // and nobody has another one
  second.cast(1);
  EXPECT_TRUE(second.channel.claims);
}

TEST_F(SharedShow, AStandbyOfAnotherSceneIsRefusedAndToldWhatDiffers) {
  const auto refusal = [&](const std::function<void(Settings&)>& change) {
    Settings settings = fewStrands();
    change(settings);
    Sharer second(stage_, settings);
    first_->channel.joined = true;
    first_->cast(1);
    const std::string failure = second.daemon->run(second.stop).failure;
    EXPECT_FALSE(second.channel.claims);
    stage_.channels.pop_back();
    return failure;
  };
  EXPECT_NE(refusal([](Settings& s) { s.scene.strands = 30; }).find("strands (30 here, 6 there)"),
            std::string::npos);
  EXPECT_NE(refusal([](Settings& s) { s.scene.length = 0.1f; }).find("strands"), std::string::npos);
  EXPECT_NE(refusal([](Settings& s) { s.solver = SolverKind::kGaussSeidel; }).find("solver"),
            std::string::npos);
  EXPECT_NE(refusal([](Settings& s) { s.scene.motion = "nod"; }).find("motion"), std::string::npos);
  EXPECT_NE(refusal([](Settings& s) {
              s.scene.materials.push_back({{}, {{"density", {1000}, "test"}}, "test"});
            }).find("materials"),
            std::string::npos);
}

}  // namespace
}  // namespace strandcast
