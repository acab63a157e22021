// Replays of recordings over the in-process channel.
#include "service/replay.h"
#include "service/daemon.h"

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <ctime>
#include <fstream>
#include <functional>
#include <set>
#include <thread>

#include "core/error.h"
#include "io/file_bytes.h"
#include "io/groom_file.h"
#include "options/scene_loading.h"
#include "service/network.h"
#include "tests/expect_error.h"
#include "tests/io/scratch_folder.h"
#include "tests/io/skinned_arm.h"
#include "tests/transport/moving_hair.h"
#include "transport/commands.h"
#include "transport/in_process.h"
#include "transport/parameter_table.h"
#include "transport/recording/recorder.h"

namespace strandcast {
namespace {

using std::chrono::milliseconds;

class ReplayTest : public testing::Test {
 protected:
  void SetUp() override {
    const GroomDescription groom = hairGroom(20, [](size_t) { return 6; });
    GroomDescription next = hairGroom(10, [](size_t) { return 5; });
    next.session = 12;
    Recorder recorder(file_, {1, {Codec::kFloat32}, ""});
    recorder.setGroom(groom, sampleBody(3));
    for (uint64_t i = 1; i <= 31; ++i) recorder.addFrame(hairFrame(groom, i));
    recorder.setGroom(next, sampleBody(3));
    for (uint64_t i = 1; i <= 31; ++i) recorder.addFrame(hairFrame(next, i));
  }
  void start(const ReplayOptions& options) {
    std::tie(publisher_, subscriber_) = makeInProcessChannel(1);
    recording_ = std::make_unique<Recording>(file_);
    thread_ = std::thread([this, options] {
      Replay replay(*recording_, *publisher_, 1, 77, options);
      summary_ = replay.run(stop_);
    });
  }
  void finish() {
    if (thread_.joinable()) thread_.join();
  }
  void TearDown() override {
    stop_ = true;
    finish();
  }
  std::string order(CommandKind kind, const std::string& name = "", std::vector<double> values = {}) {
    const Command command{.id = ++id_, .kind = kind, .name = name, .values = std::move(values)};
    subscriber_->send(command);
    return subscriber_->waitForAnswer(command.id, milliseconds(5000)).value_or("no answer");
  }

  const ScratchFolder folder_;
  const std::filesystem::path file_ = folder_ / "a.rec";
  std::unique_ptr<Publisher> publisher_;
  std::unique_ptr<Subscriber> subscriber_;
  std::unique_ptr<Recording> recording_;
  std::thread thread_;
  std::atomic<bool> stop_{false};
  ReplaySummary summary_;
  uint64_t id_ = 0;
};

TEST_F(ReplayTest, CastsEveryFrameAtItsTime) {
  start({});
  ASSERT_TRUE(subscriber_->waitForGroom(milliseconds(5000)));
  uint64_t newest = 0;
  double time = -1;
  std::set<size_t> sizes;
  while (const auto frame = subscriber_->waitForFrame(newest, milliseconds(500))) {
    EXPECT_EQ(frame->frame, newest + 1);
    EXPECT_GT(frame->simulation_time, time);
    EXPECT_EQ(frame->session, 77u);
    newest = frame->frame;
    time = frame->simulation_time;
    sizes.insert(frame->positions.size());
  }
  finish();
  EXPECT_EQ(newest, 62u);
  EXPECT_EQ(summary_.frames, 62u);
  EXPECT_EQ(summary_.damaged, 0u);
  EXPECT_GE(summary_.seconds, 1.0) << "a second of simulation takes a second";
  EXPECT_EQ(sizes, (std::set<size_t>{50, 120})) << "the second groom is announced when its frames come";
}

TEST_F(ReplayTest, SpeedAndPlaceAreChosen) {
  start({10, false, 0.25, 0.4});
  finish();
  EXPECT_EQ(summary_.frames, 10u) << "0.25 to 0.4 s at 60 Hz";
  EXPECT_LT(summary_.seconds, 0.5);
}

TEST_F(ReplayTest, LoopsAndIsMovedByCommands) {
  start({20, true});
  uint64_t newest = 0;
  for (int i = 0; i < 400 && newest < 150; ++i)
    if (const auto frame = subscriber_->waitForFrame(newest, milliseconds(100))) newest = frame->frame;
  EXPECT_GE(newest, 150u) << "more than twice round";

  EXPECT_EQ(order(CommandKind::kSetParameter, "speed", {0}), "");
  EXPECT_EQ(order(CommandKind::kSetParameter, "position", {0.2}), "");
  const double told = static_cast<double>(0.2f);
  EXPECT_EQ(namedValues(subscriber_->status()->parameters),
            (NamedValues{{"speed", {0}}, {"position", {told}}, {"loop", {1}}}));
  const uint64_t still = subscriber_->frame()->frame;
  RecordedFrame expected;
  Recording(file_).read(12, expected);
  std::shared_ptr<const GuideFrame> frame;
  for (int i = 0; i < 100 && (!frame || frame->positions != expected.frame->positions); ++i)
    frame = subscriber_->waitForFrame(still, milliseconds(50));
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->positions, expected.frame->positions) << "stands still at 0.2 s";
  const auto again = subscriber_->waitForFrame(frame->frame, milliseconds(2000));
  ASSERT_TRUE(again) << "is shown again to who comes late";
  EXPECT_EQ(again->positions, frame->positions);

  EXPECT_NE(order(CommandKind::kSetParameter, "speed", {1e-12}).find("out of range"), std::string::npos);
  EXPECT_NE(order(CommandKind::kSetParameter, "wind", {1, 2, 3}).find("does not obey"), std::string::npos);
  EXPECT_NE(order(CommandKind::kSetParameter, "position", {1e5}).find("out of range"), std::string::npos);
  EXPECT_NE(order(CommandKind::kHeadMotion, "nod").find("does not obey"), std::string::npos);
  EXPECT_EQ(order(CommandKind::kReset), "");
  EXPECT_EQ(order(CommandKind::kShutdown), "");
  finish();
}

/// Processor time of this process, s.
double processorTime() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

TEST_F(ReplayTest, AFrameThatIsDueInAnAgeIsWaitedForAsleep) {
  start({1e-12, true});
  ASSERT_TRUE(subscriber_->waitForFrame(0, milliseconds(5000)));
  const double before = processorTime();
  std::this_thread::sleep_for(milliseconds(500));
  EXPECT_LT(processorTime() - before, 0.25);
}

/// A channel with an endless supply of commands, which stops its publisher after three frames.
class FloodedChannel final : public Publisher {
 public:
  explicit FloodedChannel(std::atomic<bool>& stop) : stop_(stop) {}
  std::vector<uint64_t> taken_before;  // per frame: number of commands taken since the start
  std::optional<Command> takeCommand() override {
    return Command{.id = ++taken_, .kind = CommandKind::kReset, .name = "", .values = {}};
  }
  void publish(const GuideFrame&) override {
    taken_before.push_back(taken_);
    stop_ = taken_before.size() == 3;
  }
  void announce(const GroomDescription&, const BodyDescription&) override {}
  void announceColliders(const ColliderSet&) override {}
  void publishStatus(const Status&) override {}
  uint32_t matchedReaders() const override { return 0; }
  EncodingReport encoding() const override { return {}; }
  std::optional<ConflictingDaemon> conflict() const override { return std::nullopt; }

 private:
  std::atomic<bool>& stop_;
  uint64_t taken_ = 0;
};

TEST_F(ReplayTest, AFloodOfCommandsDoesNotHoldIt) {
  FloodedChannel channel(stop_);
  Recording recording(file_);
  Replay(recording, channel, 1, 77, {}).run(stop_);
  EXPECT_EQ(channel.taken_before, (std::vector<uint64_t>{kMaxCommandsPerFrame, 2 * kMaxCommandsPerFrame,
                                                         3 * kMaxCommandsPerFrame}));
}

TEST_F(ReplayTest, NothingToReplayIsSaid) {
  auto [publisher, subscriber] = makeInProcessChannel(1);
  Recording recording(file_);
  Replay replay(recording, *publisher, 1, 77, {1, false, 5});
  EXPECT_NE(errorOf([&] { replay.run(stop_); }).find("nothing to replay"), std::string::npos);
  EXPECT_NE(errorOf([&] { resimulate(recording, "a.rec", stop_, {}); }).find("strandcastd --record"),
            std::string::npos);
}

/// Records `frames` frames of a daemon on the reference backend, started with the arguments `words`; returns
/// the last frame's positions. `before_frame` may send commands.
std::vector<Vec3> recordRun(
    const std::filesystem::path& run, const std::vector<std::string>& words, int frames,
    const std::function<void(int frame, Subscriber&)>& before_frame = [](int, Subscriber&) {}) {
  CLI::App app;
  const SettingsOptions options(app);
  app.parse(std::vector<std::string>(words.rbegin(), words.rend()));
  auto [channel, subscriber] = makeInProcessChannel(1);
  RecordingPublisher publisher(std::move(channel), false);
  const Settings settings = options.resolve();
  Daemon daemon(settings, makeSceneWithProgress(settings.scene), publisher, 77);
  publisher.open(run, {1, {Codec::kFloat32}, simulationSource(words, options, "reference", "")});
  daemon.announce();
  const std::atomic<bool> stop{false};
  for (int frame = 0; frame < frames; ++frame) {
    before_frame(frame, *subscriber);
    daemon.castFrame(stop);
  }
  EXPECT_EQ(publisher.close(), "");
  return subscriber->frame()->positions;
}

TEST_F(ReplayTest, ARunIsRepeatedWhoseFilesHaveNamesInNoUtf8) {
  StrandSet hair;
  hair.append(std::vector<Vec3>{Vec3(0, 0.1f, 0), Vec3(0, 0.14f, 0), Vec3(0, 0.16f, 0.03f)});
  const std::filesystem::path groom = folder_ / "fris\xe9.tfx", run = folder_ / "run.rec";
  writeGroom(groom, hair);
  recordRun(run, {"--groom", groom.string(), "--unit-meters", "1", "--backend", "reference"}, 3);
  Recording recording(run);
  const ResimulationReport report = resimulate(recording, "run.rec", stop_, [](uint64_t, Simulation&) {});
  EXPECT_EQ(report.frames, 3u);
  EXPECT_EQ(report.different, 0u);
}

// Roots on the skin of a bending arm, and a ball attached to its forearm.
TEST_F(ReplayTest, ARunOnASkinnedBodyIsRepeated) {
  writeFileBytes(folder_ / "arm.glb", samples::armGlb());
  std::ofstream(folder_ / "hair.obj") << "v 0.04 0.24 0\nv 0.06 0.24 0\nv 0.08 0.24 0\nl 1 2 3\n"
                                      << "v 0.04 0.27 0\nv 0.06 0.27 0\nv 0.08 0.27 0\nl 4 5 6\n";
  const std::filesystem::path config = folder_ / "arm.toml", run = folder_ / "arm.rec";
  std::ofstream(config) << "[groom]\nfiles = [\"hair.obj\"]\nunit_meters = 1\nup = \"y\"\n"
                           "[body]\nfile = \"arm.glb\"\nclip = \"bend\"\njoint = \"upper\"\ncell = 0.01\n"
                           "[[body.primitives]]\njoint = \"lower\"\nname = \"ball\"\na = [0.09, 0.3, 0]\n"
                           "radius = 0.03\n[daemon]\nbackend = \"reference\"\n";
  const std::vector<Vec3> last = recordRun(run, {"--config", config.string()}, 40);
  EXPECT_GT((last[0] - Vec3(0.04f, 0.24f, 0)).norm(), 1e-3f) << "the elbow bends";
  Recording recording(run);
  const ResimulationReport report = resimulate(recording, "arm.rec", stop_, [](uint64_t, Simulation&) {});
  EXPECT_EQ(report.frames, 40u);
  EXPECT_EQ(report.different, 0u);
}

// Wind sources from a file and from commands, with and without a wind grid.
TEST_F(ReplayTest, ARunWhoseFansWereSteeredIsRepeated) {
  const std::filesystem::path config = folder_ / "wind.toml";
  std::ofstream(config)
      << "scene = \"straight\"\nmotion = \"nod\"\n[groom]\nstrands = 20\nvertices = 8\n"
         "[body]\ncontact = \"spheres\"\n[daemon]\nbackend = \"reference\"\n"
         "[parameters]\ngrid_cells = 16\n"
         "[[wind]]\nname = \"left\"\nkind = \"turbine\"\nradius = 1\nlength = 1\nspeed = 3\n";
  for (const std::string grid : {"0", "1"}) {
    SCOPED_TRACE(grid);
    const std::filesystem::path run = folder_ / ("wind" + grid + ".rec");
    const std::vector<std::string> words{"--config", config.string(), "--set", "wind_grid=" + grid};
    std::vector<Vec3> moved, left_alone;
    for (const bool steered : {false, true}) {
      uint64_t id = 0;
      WindSource fan;
      fan.position = Vec3(0, 0.2f, 0.4f);
      fan.direction = Vec3(0.1f, 0, -1);
      fan.length = 1;
      const auto steer = [&](int frame, Subscriber& subscriber) {
        const auto order = [&](CommandKind kind, const std::string& name, std::vector<double> values) {
          if (!steered) return;
          subscriber.send({.id = ++id, .kind = kind, .name = name, .values = std::move(values)});
        };
        if (frame == 3) order(CommandKind::kAddWindSource, "spot", windSourceValues(fan));
        fan.position.x() = 0.3f;
        fan.direction = Vec3(-0.5f, 0, -1);
        fan.speed = 7;
        if (frame == 5) order(CommandKind::kMoveWindSource, "spot", windMoveValues(fan, 1 + 2 + 32, 0.3));
        if (frame == 9) order(CommandKind::kMoveWindSource, "left", windMoveValues(fan, 32, 0.1));
        if (frame == 25) order(CommandKind::kRemoveWindSource, "left", {});
      };
      (steered ? moved : left_alone) = recordRun(run, words, 30, steer);
    }
    EXPECT_NE(moved, left_alone);
    Recording recording(run);
    const ResimulationReport report = resimulate(recording, "wind.rec", stop_, [](uint64_t, Simulation&) {});
    EXPECT_EQ(report.frames, 30u);
    EXPECT_EQ(report.inputs, 4u);
    EXPECT_EQ(report.different, 0u);
  }
}

}  // namespace
}  // namespace strandcast
