// The daemon's loop over the in-process channel.
#include "tests/apps/daemon_fixture.h"

#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <cmath>
#include <cstdlib>
#include <memory>
#include <optional>
#include <sstream>
#include <string>

#include "service/scene_simulation.h"
#include "tests/expect_error.h"
#include "transport/commands.h"
#include "transport/parameter_table.h"

namespace strandcast {
namespace {

class DaemonTest : public DaemonFixture {
 protected:
  void SetUp() override {
    const Settings settings = fewStrands();
    static const Scene scene = makeScene(settings.scene);  // shared by all tests, because the head's mesh is
                                                           // large
    start(settings, scene);
  }
  double seconds() const { return subscriber_->frame()->simulation_time; }
};

TEST_F(DaemonTest, HoldsStillWhilePausedAndTakesSingleSteps) {
  EXPECT_NE(order(CommandKind::kStep, {1}).find("pause it first"), std::string::npos);
  EXPECT_EQ(order(CommandKind::kPause, {1}), "");
  daemon_->setStepping([](const Simulation&) { return true; });  // all steps in one frame, however long they
                                                                 // take
  const double held = seconds();
  const uint64_t frame = subscriber_->frame()->frame;
  cast(5);
  EXPECT_EQ(seconds(), held);
  EXPECT_EQ(subscriber_->frame()->frame, frame + 5) << "who comes late still gets frames";
  EXPECT_EQ(order(CommandKind::kStep, {3}), "");
  EXPECT_NEAR(seconds(), held + 3.0 / 60, 1e-6);
  EXPECT_NE(order(CommandKind::kStep, {0.5}).find("whole number"), std::string::npos);
  EXPECT_EQ(order(CommandKind::kPause, {0}), "");
  EXPECT_GT(seconds(), held + 3.5 / 60);
}

TEST_F(DaemonTest, TakesManyStepsByAndBy) {
  EXPECT_EQ(order(CommandKind::kPause, {1}), "");
  daemon_->setStepping([](const Simulation&) { return false; });  // one step per frame
  const double held = seconds();
  const uint64_t frame = subscriber_->frame()->frame;
  uint64_t id = 100;
  const auto step = [&](double count) {
    subscriber_->send({.id = ++id, .kind = CommandKind::kStep, .name = "", .values = {count}});
    cast(1);
    return id;
  };
  const auto answerTo = [&](uint64_t command) {
    return subscriber_->waitForAnswer(command, std::chrono::milliseconds(0)).value_or("none yet");
  };
  const uint64_t three = step(3), one = step(1);
  EXPECT_NEAR(seconds(), held + 2.0 / 60, 1e-6);
  EXPECT_EQ(subscriber_->frame()->frame, frame + 2) << "frames go on being sent";
  EXPECT_EQ(order(CommandKind::kSetParameter, {0.001}, "time_step"), "") << "others are obeyed meanwhile";
  EXPECT_EQ(answerTo(three), "");
  EXPECT_EQ(answerTo(one), "none yet");
  cast(2);
  EXPECT_EQ(answerTo(one), "");
  EXPECT_NEAR(seconds(), held + 2.0 / 60 + 2 * 0.001, 1e-6);

  const uint64_t many = step(999);
  EXPECT_NE(answerTo(step(3)).find("998 steps are pending"), std::string::npos);
  EXPECT_EQ(order(CommandKind::kPause, {0}), "");
  EXPECT_NE(answerTo(many).find("997 steps were not taken"), std::string::npos);
}

TEST_F(DaemonTest, TheAnswerToStepsTellsOfTheStateBehindThem) {
  EXPECT_EQ(order(CommandKind::kPause, {1}), "");
  daemon_->setStepping([](const Simulation&) { return true; });
  EXPECT_EQ(order(CommandKind::kSetParameter, {100, 0, 0}, "wind"), "");
  for (const double steps : {1.0, 2.0, 30.0}) {
    EXPECT_EQ(order(CommandKind::kStep, {steps}), "");
    EXPECT_EQ(subscriber_->status()->simulation_time, seconds()) << steps;
  }
  EXPECT_GT(subscriber_->status()->max_stretch, 0) << "measured there";
}

TEST_F(DaemonTest, TheAnswerTellsWhichParametersThatWereSetDoNothing) {
  const auto told = [&] {
    std::string names;
    for (const auto& [name, values] : entriesOf(subscriber_->status()->parameters, kUnusedEntry))
      names += name + ' ';
    return names;
  };
  EXPECT_EQ(order(CommandKind::kSetParameter, {0, 0, 0}, "wind"),
            "");  // a status is there once this is answered
  EXPECT_EQ(told(), "");
  EXPECT_EQ(order(CommandKind::kSetParameter, {0.5}, "gust"), "");
  EXPECT_EQ(told(), "gust ");
  EXPECT_EQ(order(CommandKind::kSetParameter, {5}, "iterations"), "");
  EXPECT_EQ(order(CommandKind::kSetParameter, {1}, "mac_cormack"), "");
  EXPECT_EQ(told(), "gust iterations mac_cormack ");
  EXPECT_EQ(order(CommandKind::kSetParameter, {3, 0, 0}, "wind"), "");
  EXPECT_EQ(told(), "iterations mac_cormack ") << "there is a wind now";
  EXPECT_EQ(entriesOf(subscriber_->status()->parameters, "").size(), parameterList().size());
}

TEST(Backends, OfTheProcessorAskForNoGpu) {
  const char* const before = std::getenv("STRANDCAST_GPU");
  const std::string kept = before != nullptr ? before : "";
  for (const char* const bad : {"x", "15", "-1"}) {
    setenv("STRANDCAST_GPU", bad, 1);
    for (const char* const backend : {"simd", "reference"}) {
      EXPECT_EQ(errorOf([&] { knownBackends(backend); }), "") << bad << backend;
      EXPECT_EQ(knownBackends(backend).size(), 2u);
    }
  }
  unsetenv("STRANDCAST_GPU");
  if (before != nullptr) setenv("STRANDCAST_GPU", kept.c_str(), 1);
  EXPECT_EQ(knownBackends("none").size(), 3u) << "those to choose among";
}

TEST_F(DaemonTest, AMotionBeginsWhereTheHeadIs) {
  EXPECT_EQ(order(CommandKind::kHeadPose, {0.1, 0, 0, 0, 0.9, 0, std::sqrt(1 - 0.81)}), "");
  cast(20);
  for (const char* const motion : {"nod", "still"}) {
    const Pose before = subscriber_->frame()->head;
    EXPECT_EQ(order(CommandKind::kHeadMotion, {}, motion), "");
    const Pose after = subscriber_->frame()->head;
    // The head turns by 2.2 rad within 12 frames (kRampSeconds).
    EXPECT_LT(after.rotation.angularDistance(before.rotation), 0.3f) << motion;
    EXPECT_LT((after.position - before.position).norm(), 0.02f) << motion;
    cast(20);
  }
  EXPECT_NEAR(subscriber_->frame()->head.rotation.angularDistance(Quat::Identity()), 0, 1e-3f);
  EXPECT_NEAR(subscriber_->frame()->head.position.norm(), 0, 1e-5f);
}

TEST_F(DaemonTest, AHandPullsUntilItLetsGoOrNobodyMovesIt) {
  const size_t tip = 7;
  cast(10);
  const Vec3 rest = subscriber_->frame()->positions[tip];
  const Vec3 to = rest + Vec3(0, 0.03f, 0.05f);
  const std::vector<double> pull{rest.x(), rest.y(), rest.z(), 0.001, to.x(), to.y(), to.z(), 100};
  EXPECT_NE(order(CommandKind::kPull, {1, 2, 3}).find("8 numbers"), std::string::npos);
  EXPECT_EQ(order(CommandKind::kPull, pull), "");
  cast(50);
  const float held = (subscriber_->frame()->positions[tip] - rest).norm();
  EXPECT_GT(held, 0.02f);
  cast(300);
  EXPECT_LT((subscriber_->frame()->positions[tip] - rest).norm(), 0.3f * held) << "after a second";
  EXPECT_EQ(order(CommandKind::kPull, pull), "");
  EXPECT_EQ(order(CommandKind::kPull, {}), "");
  cast(20);
  EXPECT_LT((subscriber_->frame()->positions[tip] - rest).norm(), 0.3f * held);
}

TEST_F(DaemonTest, AResetLetsGoAndMeasuresAnew) {
  const size_t tip = 7;
  cast(2);
  const Vec3 rest = subscriber_->frame()->positions[tip];
  const Vec3 to = rest + Vec3(0, 0.05f, 0.2f);
  const std::vector<double> pull{rest.x(), rest.y(), rest.z(), 0.001, to.x(), to.y(), to.z(), 100};
  const std::vector<double> head{0, 0.05, 0, 0, 0, 0, 1};  // upwards, away from the shoulders
  EXPECT_EQ(order(CommandKind::kHeadPose, head), "");
  EXPECT_EQ(order(CommandKind::kPull, pull), "");
  std::vector<double> ball(25);  // a sphere: pose from index 2, shape from index 9
  ball[2] = 5;                   // far from the hair
  ball[8] = ball[24] = 1;
  ball[15] = 0.05;
  EXPECT_EQ(order(CommandKind::kAddCollider, ball, "ball"), "");
  EXPECT_EQ(order(CommandKind::kMoveCollider, {1, 1, 1, 0, 0, 0, 1, 1}, "ball"), "");
  cast(30);
  EXPECT_EQ(order(CommandKind::kReset, {}), "");
  const auto status = subscriber_->status();
  EXPECT_EQ(status->max_stretch, 0);
  EXPECT_EQ(status->max_penetration, 0);
  EXPECT_EQ(status->strands_reset, 0u);
  const auto frame = subscriber_->frame();
  EXPECT_NEAR(frame->head.position.y(), 0.05f, 1e-4f) << "the head stays where it is";
  cast(5);
  const Vec3 carried = rest + Vec3(0, 0.05f, 0);
  EXPECT_LT((subscriber_->frame()->positions[tip] - carried).norm(), 0.01f) << "the hand has let go";
  ASSERT_EQ(frame->colliders.size(), 2u);
  EXPECT_NE(subscriber_->frame()->colliders.back().pose.position, frame->colliders.back().pose.position)
      << "a collider goes on";
}

TEST_F(DaemonTest, ARefusalNamesTheCommandAsItIsGiven) {
  const auto where = [&](CommandKind kind, std::vector<double> values, const std::string& name) {
    const std::string refusal = order(kind, std::move(values), name);
    const size_t from = refusal.find(": strandcast ctl "), to = refusal.find(';');
    return from == std::string::npos ? refusal : refusal.substr(from + 2, to - from - 2);
  };
  EXPECT_EQ(where(CommandKind::kSetParameter, {-5}, "air_drag"), "strandcast ctl set air_drag");
  EXPECT_EQ(where(CommandKind::kMoveCollider, {0, 0, 0, 0, 0, 0, 1}, "rod"),
            "strandcast ctl collider move rod");
  EXPECT_EQ(where(CommandKind::kRemoveCollider, {}, "a rod"), "strandcast ctl collider remove a rod");
  EXPECT_EQ(where(CommandKind::kRemoveWindSource, {}, "fan"), "strandcast ctl fan remove fan");
  EXPECT_EQ(where(CommandKind::kStep, {3}, ""), "strandcast ctl step");
  EXPECT_EQ(where(CommandKind::kPull, {3}, ""), "strandcast ctl pull");
  EXPECT_EQ(where(CommandKind::kAddColliderFile, std::vector<double>(12), "chair a.glb"),
            "strandcast ctl collider add chair");
}

TEST_F(DaemonTest, ItsStatusTellsParametersAsTheyAre) {
  const auto told = [&](const std::string& name) {
    for (const auto& [known, values] : namedValues(subscriber_->status()->parameters))
      if (known == name) return values;
    return std::vector<double>();
  };
  EXPECT_NE(order(CommandKind::kSetParameter, {-5}, "air_drag"), "");
  const double usual = told("air_drag").at(0);
  EXPECT_GE(usual, 0) << "what was refused is not told";
  EXPECT_EQ(order(CommandKind::kSetParameter, {usual + 2}, "air_drag"), "");
  EXPECT_EQ(told("air_drag"), std::vector<double>{usual + 2}) << "the answer tells it";
  EXPECT_EQ(order(CommandKind::kSetParameter, {1, 0, -3}, "wind"), "");
  EXPECT_EQ(told("wind"), (std::vector<double>{1, 0, -3}));
  EXPECT_EQ(namedValues(subscriber_->status()->parameters).size(), parameterList().size());
}

TEST_F(DaemonTest, AFloodOfCommandsDoesNotHoldTheHair) {
  cast(1);
  const double before = seconds();
  for (uint64_t id = 1; id <= kMaxQueuedCommands; ++id)
    subscriber_->send({.id = id, .kind = CommandKind::kSetParameter, .name = "air_drag", .values = {1}});
  cast(1);
  EXPECT_EQ(subscriber_->status()->last_command, kMaxCommandsPerFrame);
  EXPECT_GT(seconds(), before);
  cast(1);
  EXPECT_EQ(subscriber_->status()->last_command, 2 * kMaxCommandsPerFrame) << "the others waited";
}

TEST_F(DaemonTest, TheObserverSeesEveryFrame) {
  int seen = 0;
  daemon_->setObserver([&](Simulation& simulation) {
    ++seen;
    EXPECT_EQ(simulation.guides().size(), 160u);
  });
  cast(3);
  EXPECT_EQ(seen, 3);
}

/// A channel that reports the conflicting daemon `heard`.
class RivalChannel final : public Publisher {
 public:
  std::optional<ConflictingDaemon> heard;
  std::optional<ConflictingDaemon> conflict() const override { return heard; }
  void announce(const GroomDescription&, const BodyDescription&) override {}
  void announceColliders(const ColliderSet&) override {}
  void publish(const GuideFrame&) override {}
  void publishStatus(const Status&) override {}
  std::optional<Command> takeCommand() override { return std::nullopt; }
  uint32_t matchedReaders() const override { return 0; }
  EncodingReport encoding() const override { return {}; }
};

/// The result of ConflictDetector::check() of session 0x80 for the conflicting daemon `heard`, after `frames`
/// frames.
struct WatchResult {
  std::string said, ends;
};
WatchResult look(ConflictDetector& watch, std::optional<ConflictingDaemon> heard, uint64_t frames,
                 std::chrono::seconds casting) {
  RivalChannel channel;
  channel.heard = heard;
  std::ostringstream text;
  const auto logger = spdlog::default_logger();
  spdlog::set_default_logger(
      std::make_shared<spdlog::logger>("test", std::make_shared<spdlog::sinks::ostream_sink_st>(text)));
  const std::optional<std::string> ends = watch.check(channel, 0x80, frames, casting);
  spdlog::set_default_logger(logger);
  return {text.str(), ends.value_or("")};
}

TEST(RivalWatchTest, TellsOnceOfEachThatCasts) {
  ConflictDetector watch(7);
  const auto said = [&](std::optional<ConflictingDaemon> heard) {
    const WatchResult looked = look(watch, heard, 6000, std::chrono::seconds(100));
    EXPECT_EQ(looked.ends, "") << "who has cast for long stays";
    return looked.said;
  };
  EXPECT_EQ(said(std::nullopt), "");
  EXPECT_EQ(said(ConflictingDaemon{0xab, false}), "") << "it starts, hears of this one and goes";
  EXPECT_NE(said(ConflictingDaemon{0xab, true}).find("session 00000000000000ab, also publishes groom 7"),
            std::string::npos);
  EXPECT_EQ(said(ConflictingDaemon{0xab, true}), "");
  EXPECT_NE(said(ConflictingDaemon{0xcd, true}).find("session 00000000000000cd"), std::string::npos);
}

TEST(RivalWatchTest, OfTwoThatHearEachOtherLateTheOneThatHasCastForLessEnds) {
  const auto ends = [](ConflictingDaemon heard, uint64_t frames) {
    ConflictDetector watch(7);
    return !look(watch, heard, frames, std::chrono::seconds(3)).ends.empty();
  };
  EXPECT_TRUE(ends({0xff, true, 100000}, 180)) << "the other one was there before";
  EXPECT_FALSE(ends({0x01, true, 10}, 180)) << "the other one came later";
  EXPECT_TRUE(ends({0x01, true, 170}, 180)) << "both began at once: the higher session ends";
  EXPECT_FALSE(ends({0xff, true, 170}, 180));
  EXPECT_FALSE(ends({0x01, false, 0}, 180)) << "one that starts gives way";
}

}  // namespace
}  // namespace strandcast
