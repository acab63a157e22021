// What commands control of a simulation, without a daemon or a network: colliders, execution, status and
// shows.
#include "service/command_executor.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "core/error.h"
#include "service/show_state.h"
#include "tests/collision/shapes.h"
#include "tests/expect_error.h"
#include "tests/io/scratch_folder.h"
#include "transport/chunks.h"
#include "transport/parameter_table.h"

namespace strandcast {
namespace {

/// A channel that keeps the colliders announced last.
class ColliderChannel final : public Publisher {
 public:
  ColliderSet newest;
  void announceColliders(const ColliderSet& colliders) override { newest = colliders; }
  void announce(const GroomDescription&, const BodyDescription&) override {}
  void publish(const GuideFrame&) override {}
  void publishStatus(const Status&) override {}
  std::optional<Command> takeCommand() override { return std::nullopt; }
  uint32_t matchedReaders() const override { return 0; }
  EncodingReport encoding() const override { return {}; }
  std::optional<ConflictingDaemon> conflict() const override { return std::nullopt; }
};

/// A simulation of few strands, and commands for it.
class ControlledTest : public ::testing::Test {
 protected:
  static constexpr uint64_t kSession = 5;

  static Settings settings() {
    Settings settings;
    settings.scene.name = "straight";
    settings.scene.strands = 20;
    settings.scene.vertices = 8;
    settings.scene.motion = "still";
    settings.scene.body_contact = BodyContact::kSpheres;
    settings.backend = "reference";
    return settings;
  }
  static const Scene& scene() {
    static const Scene scene = makeScene(settings().scene);
    return scene;
  }
  static Command commandOf(CommandKind kind, std::vector<double> values, const std::string& name = "") {
    static uint64_t id = 0;
    return {.id = ++id, .kind = kind, .name = name, .values = std::move(values)};
  }
  static Command addBall(const std::string& name, double z) {
    ContactPrimitive shape;
    shape.radius = 0.04f;
    std::vector<double> values = {0, 0, 0, 0, z, 0, 0, 0, 1};
    shapeNumbers(shape, [&](float n) { values.push_back(static_cast<double>(n)); });
    return commandOf(CommandKind::kAddCollider, values, name);
  }

  ColliderChannel channel_;
  ControlledSimulation controlled_{settings(), scene(), channel_, kSession};
  ColliderRegistry& colliders_ = controlled_.colliders;
};

using ColliderRegistryTest = ControlledTest;

TEST_F(ColliderRegistryTest, AddsMovesAndRemovesByName) {
  colliders_.add(addBall("ball", 0.5), "here");
  EXPECT_EQ(channel_.newest.session, kSession);
  EXPECT_EQ(channel_.newest.revision, 1u);
  EXPECT_EQ(channel_.newest.colliders.size(), scene().bodies.size() + 1);
  EXPECT_EQ(colliders_.named().at("ball").body, channel_.newest.colliders.back().id);
  const auto z = [&](double time) {
    colliders_.advance(time);
    controlled_.simulation.step();
    return colliders_.placed().back().pose.position.z();
  };
  EXPECT_FLOAT_EQ(z(0), 0.5f);
  const double start = controlled_.simulation.time();
  colliders_.move(commandOf(CommandKind::kMoveCollider, {0, 0, 0.3, 0, 0, 0, 1, 1}, "ball"), "here");
  EXPECT_NEAR(z(start + 0.5), 0.4f, 1e-6f);
  EXPECT_TRUE(colliders_.named().at("ball").tween);
  EXPECT_FLOAT_EQ(z(start + 1), 0.3f);
  EXPECT_FALSE(colliders_.named().at("ball").tween) << "the motion has ended";
  EXPECT_EQ(channel_.newest.revision, 1u) << "motion is no new description";
  colliders_.remove(commandOf(CommandKind::kRemoveCollider, {}, "ball"), "here");
  EXPECT_EQ(channel_.newest.revision, 2u);
  EXPECT_FALSE(colliders_.has("ball"));
  EXPECT_EQ(controlled_.simulation.bodies(), scene().bodies.size());
}

TEST_F(ColliderRegistryTest, ARefusedCommandChangesNothing) {
  colliders_.add(addBall("ball", 0.5), "here");
  Command field = addBall("field", 0.5);
  field.values[0] = 7;
  for (const Command& bad : {addBall("ball", 0.1), addBall("", 0.1), field})
    EXPECT_NE(errorOf([&] { colliders_.add(bad, "here"); }).find("here"), std::string::npos) << bad.name;
  const Command late = commandOf(CommandKind::kMoveCollider, {0, 0, 0, 0, 0, 0, 1, -1}, "ball");
  EXPECT_NE(errorOf([&] { colliders_.move(late, "here"); }).find("takes 0 to"), std::string::npos);
  EXPECT_NE(errorOf([&] {
              colliders_.remove(commandOf(CommandKind::kRemoveCollider, {}, "cube"), "here");
            }).find("unknown collider 'cube'"),
            std::string::npos);
  EXPECT_EQ(colliders_.named().size(), 1u);
  EXPECT_FALSE(colliders_.named().at("ball").tween);
  EXPECT_EQ(channel_.newest.revision, 1u);
}

TEST_F(ColliderRegistryTest, ABodyOfAFileIsAddedUnlessItsCheckRefusesIt) {
  const ScratchFolder folder;
  writeObj(folder / "cube.obj", shapes::box(Vec3(0.05f, 0.02f, 0.03f)));
  ColliderRegistry registry(scene(), folder.path(), controlled_.simulation, channel_, kSession);
  ColliderFile file;
  file.name = "cube";
  file.file = "cube.obj";
  file.kind = PrimitiveKind::kConvex;
  Command command = colliderFileCommand(file);
  const auto made = [&](uint64_t id, ColliderRegistry::MadeCheck check) {
    command.id = id;
    registry.addFile(command, "here", std::move(check));
    EXPECT_TRUE(registry.has("cube")) << "the name is in use while it is made";
    for (int i = 0; i < 300; ++i) {
      if (auto result = registry.addNextMade()) return *result;
      registry.waitForMade(std::chrono::milliseconds(100));
    }
    return ColliderRegistry::MadeResult{0, "nothing"};
  };
  const auto refused = made(1, [](const ColliderMaker::Made&) { throw Error("not this one", "here", ""); });
  EXPECT_EQ(refused.command, 1u);
  EXPECT_NE(refused.refusal.find("not this one"), std::string::npos);
  EXPECT_FALSE(registry.has("cube"));
  EXPECT_EQ(made(2, {}).refusal, "");
  EXPECT_TRUE(registry.named().at("cube").mesh_hash);
  EXPECT_EQ(registry.named().at("cube").command->id, 2u);
}

/// An executor whose answers are kept.
class CommandExecutorTest : public ControlledTest {
 protected:
  /// Executes a command and returns the answers that came meanwhile, one after another; "-" where none came.
  std::string order(CommandKind kind, std::vector<double> values, const std::string& name = "") {
    return order(commandOf(kind, std::move(values), name));
  }
  std::string order(const Command& command) {
    answers_.clear();
    executor_.execute(command);
    std::string text = answers_.empty() ? "-" : "";
    for (const auto& [id, refusal] : answers_) text += refusal + (id == command.id ? "." : "; ");
    return text;
  }
  static bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  }

  StatusReport report_{1, kSession, "straight", controlled_.simulation};
  std::vector<std::pair<uint64_t, std::string>> answers_;
  CommandExecutor executor_{controlled_, report_, [this](uint64_t command, const std::string& refusal) {
                              answers_.emplace_back(command, refusal);
                            }};
};

TEST_F(CommandExecutorTest, AnswersWhenTheStatusHasTheNewValues) {
  EXPECT_EQ(order(CommandKind::kSetParameter, {3}, "air_drag"), ".");
  EXPECT_EQ(controlled_.simulation.parameters().air_drag, 3);
  EXPECT_EQ(namedValues(report_.status().parameters), namedValues(controlled_.table()));
  EXPECT_TRUE(contains(order(CommandKind::kSetParameter, {-5}, "air_drag"), "strandcast ctl set air_drag"));
  EXPECT_EQ(order(addBall("ball", 0.5)), ".");
  EXPECT_EQ(entriesOf(report_.status().parameters, kColliderEntry).size(), 1u);
  EXPECT_TRUE(contains(order(static_cast<CommandKind>(999), {}), "unknown kind of command"));
}

TEST_F(CommandExecutorTest, StepsAreAnsweredByWhoTakesThemOrWhenTheyAreDropped) {
  EXPECT_TRUE(contains(order(CommandKind::kStep, {3}), "pause it first"));
  EXPECT_EQ(order(CommandKind::kPause, {1}), ".");
  EXPECT_EQ(order(CommandKind::kStep, {3}), "-");
  EXPECT_TRUE(contains(order(CommandKind::kStep, {998}), "3 steps are pending"));
  EXPECT_FALSE(controlled_.steps.countStep());
  const std::string dropped = order(CommandKind::kReset, {});
  EXPECT_TRUE(contains(dropped, "2 steps were not taken")) << dropped;
  EXPECT_TRUE(dropped.ends_with("; .")) << "then the reset itself";
  EXPECT_TRUE(controlled_.steps.requests().empty());
  EXPECT_TRUE(controlled_.steps.isPaused());
}

TEST_F(CommandExecutorTest, AResetForgetsWhatWasMeasured) {
  controlled_.advance();
  report_.addStep(2, 4);
  report_.measure();
  EXPECT_EQ(report_.status().strands_reset, 4u);
  EXPECT_EQ(report_.status().step_ms_median, 2);
  EXPECT_EQ(order(CommandKind::kReset, {}), ".");
  EXPECT_EQ(report_.status().strands_reset, 0u);
  EXPECT_EQ(report_.status().max_stretch, 0);
  EXPECT_EQ(controlled_.resets, 1u);
  EXPECT_FALSE(executor_.isShutDown());
  EXPECT_EQ(order(CommandKind::kShutdown, {}), ".");
  EXPECT_TRUE(executor_.isShutDown());
}

TEST_F(CommandExecutorTest, SlicesMeasureWhatOneMeasurementDoes) {
  controlled_.hand.pull(commandOf(CommandKind::kPull, {0, 0.1, 0, 0.2, 0, 0.3, 0.1, 100}), "here");
  for (int i = 0; i < 5; ++i) controlled_.advance();
  StatusReport whole(1, kSession, "straight", controlled_.simulation);
  whole.measure();
  for (const size_t strands : {7, 8, 3}) report_.measureSlice(strands);
  report_.measure();
  EXPECT_EQ(report_.status().max_stretch, whole.status().max_stretch);
  EXPECT_NEAR(report_.status().mean_stretch, whole.status().mean_stretch, 1e-12);
  EXPECT_EQ(report_.status().simulation_time, controlled_.simulation.time());
}

TEST_F(CommandExecutorTest, AShowCarriesWhatCommandsHaveChanged) {
  EXPECT_EQ(order(CommandKind::kSetParameter, {3}, "air_drag"), ".");
  EXPECT_EQ(order(addBall("ball", 0.5)), ".");
  EXPECT_EQ(order(CommandKind::kMoveCollider, {0, 0, 0.3, 0, 0, 0, 1, 2}, "ball"), ".");
  EXPECT_EQ(order(CommandKind::kHeadMotion, {}, "nod"), ".");
  for (int i = 0; i < 5; ++i) controlled_.advance();
  EXPECT_EQ(order(CommandKind::kPause, {1}), ".");
  EXPECT_EQ(order(CommandKind::kStep, {5}), "-");
  ShowState own(settings(), {}, controlled_, report_);
  own.recordAnswer(7, "refused");
  const Show show = own.make(true);

  ColliderChannel channel;
  ControlledSimulation other(settings(), scene(), channel, 6);
  StatusReport report(1, 6, "straight", other.simulation);
  ShowState state(settings(), {}, other, report);
  EXPECT_EQ(state.restoreFrom(show), 0) << "the hair is at the show's time";
  EXPECT_EQ(other.simulation.time(), controlled_.simulation.time());
  EXPECT_EQ(namedValues(report.status().parameters), namedValues(controlled_.table()));
  EXPECT_EQ(other.colliders.placed().back().pose.position, colliders_.placed().back().pose.position);
  EXPECT_TRUE(other.colliders.named().at("ball").tween);
  EXPECT_EQ(other.head.control(), controlled_.head.control());
  EXPECT_TRUE(other.steps.isPaused());
  EXPECT_EQ(other.steps.requests().front().left, 5);
  EXPECT_TRUE(state.knows(7) && state.knows(other.steps.requests().front().command));
  EXPECT_EQ(state.answers(), own.answers());
}

}  // namespace
}  // namespace strandcast
