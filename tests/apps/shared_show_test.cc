// Takeover between daemons that share a groom: two daemons in this process on a channel that serialises
// shows.
#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <fstream>
#include <functional>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "service/daemon.h"
#include "service/show_fingerprint.h"
#include "tests/collision/shapes.h"
#include "tests/io/scratch_folder.h"
#include "transport/parameter_table.h"
#include "transport/show.h"

namespace strandcast {
namespace {

class StageChannel;

/// Which of a groom's channels casts.
struct Stage {
  std::vector<StageChannel*> channels;
  StageChannel* casts = nullptr;
};

class StageChannel final : public Publisher {
 public:
  explicit StageChannel(Stage& stage) : stage_(stage) { stage_.channels.push_back(this); }

  GuideFrame newest;             ///< frame published last
  std::deque<Command> commands;  ///< queue for takeCommand()
  std::vector<Status> told;      ///< statuses published while it casts
  bool joined = false;           ///< another daemon has joined and needs the hair
  bool claims = false;           ///< has published a frame
  bool is_equal = false;         ///< its claim is as strong as that of the casting daemon
  bool tells_meshes = true;      ///< false: as an older daemon
  std::deque<std::vector<uint8_t>> shows;
  uint64_t show_session = 0;

  std::optional<ConflictingDaemon> conflict() const override { return std::nullopt; }
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
  CastingState castingState() const override {
    if (stage_.casts == nullptr) return CastingState::kUnclaimed;
    return stage_.casts == this ? CastingState::kOwn : CastingState::kOther;
  }
  bool yields() const override { return is_equal && castingState() == CastingState::kOther; }
  void withdrawClaim() override { claims = false; }
  size_t sharers() const override { return stage_.channels.size() - 1; }
  bool wantsHair() const override { return joined; }
  void publishShow(const Show& told_show) override {
    Show show = told_show;
    if (!tells_meshes)
      std::erase_if(show.entries, [](const ShowEntry& entry) { return entry.name.starts_with("mesh of "); });
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
  void SetUp() override { begin(fewStrands()); }
  void begin(const Settings& settings) {
    first_ = std::make_unique<Sharer>(stage_, settings);
    first_->cast(1);
    stage_.casts = &first_->channel;
  }
  /// Sends a command to every daemon of the stage, as over a network, then casts one frame of the first.
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
  /// A second daemon joins and catches up with the first.
  std::unique_ptr<Sharer> join(const Settings& settings = fewStrands()) {
    auto second = std::make_unique<Sharer>(stage_, settings);
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
  /// Makes the first daemon publish its show, which otherwise happens by the clock.
  void tell() { EXPECT_EQ(order(CommandKind::kSetParameter, {0.3}, "body_friction_unknown").empty(), false); }
  /// Casts frames of both daemons until their times match.
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
  // They stay equal while the clip and the motions go on.
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
  // Removes it and adds another shape under the same name.
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
  second->channel.commands.push_back(last);  // the casting daemon did not receive it
  second->cast(1);
  EXPECT_TRUE(second->channel.told.empty()) << "a standby answers nobody";
  stage_.casts = nullptr;  // it has ended
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
  stage_.casts = nullptr;  // and no other daemon casts
  second.cast(1);
  EXPECT_TRUE(second.channel.claims);
}

TEST_F(SharedShow, OfAnEqualClaimStandsByUntilTheOtherOneIsGone) {
  addBall("ball", 0.1);
  Sharer second(stage_, fewStrands());
  second.channel.is_equal = true;
  first_->channel.joined = true;
  first_->cast(1);
  for (int news = 0; news < 20; ++news) {
    tell();
    second.cast(1);
  }
  EXPECT_FALSE(second.channel.claims) << "it has the show, and leaves the turn to who has it";
  EXPECT_EQ(second.channel.newest.colliders.size(), 0u);
  stage_.casts = nullptr;
  second.cast(1);
  EXPECT_TRUE(second.channel.claims);
  EXPECT_EQ(second.channel.newest.colliders.size(), 2u) << "the scene's shoulders, and the ball";
}

/// Daemons with collider folders of their own, and colliders from files.
class SharedMeshes : public SharedShow {
 protected:
  void SetUp() override {
    writeObj(here_ / "stone.obj", shapes::sphere(0.04f, 2));
    writeObj(here_ / "cube.obj", shapes::box(Vec3(0.05f, 0.02f, 0.03f)));
    spdlog::set_default_logger(std::make_shared<spdlog::logger>(
        "test", std::make_shared<spdlog::sinks::ostream_sink_mt>(log_, true)));
    begin(of(here_));
    second_ = join(of(there_));
  }
  void TearDown() override { spdlog::set_default_logger(before_); }
  static Settings of(const ScratchFolder& folder) {
    Settings settings = fewStrands();
    settings.scene.body_contact = BodyContact::kSpheres;
    settings.collider_folder = folder.path();
    return settings;
  }
  /// The casting daemon makes a collider from its file, and the second one from its own file of the same
  /// name. Returns the second daemon's log message, or "made".
  std::string make(const std::string& name, const std::string& file, PrimitiveKind kind) {
    ColliderFile collider;
    collider.name = name;
    collider.file = file;
    collider.kind = kind;
    if (kind == PrimitiveKind::kField) collider.cell = 0.01f;
    const Command command = colliderFileCommand(collider);
    const size_t before = second_->channel.newest.colliders.size();
    log_.str("");
    order(CommandKind::kAddColliderFile, command.values, command.name);
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (std::chrono::steady_clock::now() < end) {
      tell();
      second_->cast(1);
      if (second_->channel.newest.colliders.size() > before) return "made";
      if (log_.str().find("lacks a collider") != std::string::npos) return log_.str();
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return "nothing";
  }

  const ScratchFolder here_, there_;
  std::ostringstream log_;
  const std::shared_ptr<spdlog::logger> before_ = spdlog::default_logger();
  std::unique_ptr<Sharer> second_;
};

TEST_F(SharedMeshes, OfOneMeshAreMadeHoweverItIsWritten) {
  writeObj(there_ / "stone.obj", shapes::sphere(0.04f, 2));
  std::ofstream(there_ / "stone.obj", std::ios::app) << "# of another hand\n";
  writeObj(there_ / "cube.obj", shapes::box(Vec3(0.05f, 0.02f, 0.03f)));
  EXPECT_EQ(make("a", "stone.obj", PrimitiveKind::kConvex), "made");
  EXPECT_EQ(make("b", "stone.obj", PrimitiveKind::kField), "made");
  EXPECT_EQ(make("c d %", "cube.obj", PrimitiveKind::kConvex), "made");
}

TEST_F(SharedMeshes, OfAnotherMeshAreLackedByName) {
  TriangleMesh dented = shapes::sphere(0.04f, 2);
  dented.positions[5] *= 0.999f;  // its grid is unchanged
  writeObj(there_ / "stone.obj", dented);
  writeObj(there_ / "cube.obj", shapes::box(Vec3(0.05f, 0.03f, 0.03f)));
  const size_t before = second_->channel.newest.colliders.size();
  for (const auto& [name, file, kind] : {std::tuple{"a", "stone.obj", PrimitiveKind::kField},
                                         {"b", "stone.obj", PrimitiveKind::kConvex},
                                         {"c", "cube.obj", PrimitiveKind::kConvex},
                                         {"c d", "cube.obj", PrimitiveKind::kField}}) {
    const std::string told = make(name, file, kind);
    EXPECT_NE(told.find("mesh differs from the publishing daemon's"), std::string::npos) << told;
    EXPECT_NE(told.find(std::string("collider ") + name + " of the show"), std::string::npos) << told;
    tell();
    second_->cast(1);
    EXPECT_FALSE(second_->channel.claims) << "others that have it take over";
  }
  for (const char* const name : {"a", "b", "c", "c d"})
    EXPECT_EQ(order(CommandKind::kRemoveCollider, {}, name), "");
  second_->cast(1);  // catches up with the time of the first daemon
  tell();
  second_->cast(1);
  EXPECT_TRUE(second_->channel.claims) << "it lacks nothing now";
  EXPECT_NE(make("a", "stone.obj", PrimitiveKind::kConvex), "made");
  stage_.casts = nullptr;
  second_->cast(2);
  EXPECT_TRUE(second_->channel.claims) << "there is no other one";
  EXPECT_EQ(second_->channel.newest.colliders.size(), before) << "rather none than another body";
}

TEST_F(SharedMeshes, OfADaemonThatTellsNoneAreTaken) {
  first_->channel.tells_meshes = false;
  writeObj(there_ / "stone.obj", shapes::sphere(0.05f, 2));
  EXPECT_EQ(make("a", "stone.obj", PrimitiveKind::kConvex), "made");
}

TEST(ShowFingerprints, NameTheSceneColliderWhoseMeshDiffers) {
  const auto of = [](const std::map<std::string, uint64_t>& meshes) {
    Scene scene;
    scene.mesh_hashes = meshes;
    return fingerprintOf(scene, {});
  };
  const std::string long_name(250, 'x');
  const auto own = of({{"chair", 5}, {"", 6}, {long_name, 7}});
  for (const ShowEntry& entry : own) EXPECT_LE(entry.name.size(), 255u);
  EXPECT_EQ(differenceOf(own, own), "");
  EXPECT_EQ(differenceOf(own, of({{"chair", 1}, {"", 6}, {long_name, 7}})), "mesh of collider chair");
  EXPECT_EQ(differenceOf(own, of({{"chair", 5}, {"", 1}, {long_name, 7}})),
            "meshes of colliders without a name");
  EXPECT_NE(differenceOf(own, of({{"chair", 5}, {"", 6}, {long_name, 8}})), "");
  EXPECT_EQ(differenceOf(own, of({})), "") << "of a daemon that tells none";
  EXPECT_EQ(meshHashIn({meshEntry("a b", ~uint64_t{0})}, "a b"), ~uint64_t{0});
  EXPECT_EQ(meshHashIn({meshEntry("a b", 3)}, "a"), 0u);
  EXPECT_EQ(meshHashIn({{ShowKind::kFingerprint, "mesh of added collider a", {1, -1, 1e300}}}, "a"), 0u);
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
