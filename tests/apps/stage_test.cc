// Several characters in one process: each as in a daemon of its own.
#include "service/stage.h"

#include <gtest/gtest.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <CLI/CLI.hpp>

#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <thread>

#include "service/replay.h"
#include "tests/expect_error.h"
#include "tests/thorough.h"
#include "transport/in_process.h"
#include "transport/metrics.h"
#include "transport/recording/recording.h"

namespace strandcast {
namespace {

using namespace std::chrono_literals;

/// Keeps log lines as they are printed. Thread-safe.
class KeptLog final : public spdlog::sinks::base_sink<std::mutex> {
 public:
  std::vector<std::string> lines() {
    const std::lock_guard lock(mutex_);
    return lines_;
  }

 private:
  void sink_it_(const spdlog::details::log_msg& message) override {
    spdlog::memory_buf_t text;
    formatter_->format(message, text);
    lines_.emplace_back(text.data(), text.size());
  }
  void flush_() override {}
  std::vector<std::string> lines_;
};

/// A stage over in-process channels, in a thread of its own, and its readers.
class StageTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder_);
    spdlog::set_default_logger(std::make_shared<spdlog::logger>("stage", log_));
  }
  void TearDown() override {
    end();
    spdlog::set_default_logger(before_);
    std::filesystem::remove_all(folder_);
  }

  /// 20 strands; each groom id has another shape of hair.
  CharacterSettings character(uint32_t groom_id) const {
    CharacterSettings out;
    Settings& settings = out.settings;
    settings.groom_id = groom_id;
    settings.scene.name = groom_id % 2 == 0 ? "curly" : "straight";
    settings.scene.strands = 20;
    settings.scene.vertices = 8;
    settings.scene.seed = groom_id;
    settings.scene.motion = groom_id % 3 == 0 ? "shake" : "nod";
    settings.backend = "simd";
    settings.rate = 100;
    settings.parameters = {{"time_step", {0.01}}};
    return out;
  }
  void start(
      std::vector<CharacterSettings> characters,
      const RecordingSource& source = [](uint32_t, const std::string&, const std::string&) {
        return std::string();
      }) {
    stop_ = false;
    shareMachine(characters, 2);
    stage_.emplace(std::move(characters), source, [this](const Settings& settings, uint64_t) {
      auto [publisher, subscriber] = makeInProcessChannel(settings.groom_id);
      const std::lock_guard lock(mutex_);
      readers_[settings.groom_id] = std::move(subscriber);
      return std::move(publisher);
    });
    thread_ = std::jthread([this] { endings_ = stage_->run(stop_); });
  }
  std::vector<CharacterEnding> end() {
    stop_ = true;
    thread_ = {};
    return endings_;
  }
  Subscriber& reader(uint32_t groom_id) {
    for (;;) {
      {
        const std::lock_guard lock(mutex_);
        if (readers_.contains(groom_id)) return *readers_[groom_id];
      }
      std::this_thread::sleep_for(5ms);
    }
  }
  /// Waits until the character has cast so many frames; false where that takes a minute.
  bool waitForFrames(uint32_t groom_id, uint64_t frames) {
    Subscriber& subscriber = reader(groom_id);
    for (const auto end = std::chrono::steady_clock::now() + 60s; std::chrono::steady_clock::now() < end;
         std::this_thread::sleep_for(5ms))
      if (const auto frame = subscriber.frame(); frame && frame->frame >= frames) return true;
    return false;
  }
  size_t linesOfLog(const std::string& part) const {
    size_t count = 0;
    for (const std::string& line : log_->lines()) count += line.find(part) != std::string::npos;
    return count;
  }
  std::string log() const {
    std::string text;
    for (const std::string& line : log_->lines()) text += line;
    return text;
  }

  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("strandcast_stage_" + std::to_string(getpid()));

 private:
  const std::shared_ptr<KeptLog> log_ = std::make_shared<KeptLog>();
  std::shared_ptr<spdlog::logger> before_ = spdlog::default_logger();
  std::mutex mutex_;
  std::map<uint32_t, std::unique_ptr<Subscriber>> readers_;
  std::atomic<bool> stop_{false};
  std::optional<Stage> stage_;
  std::vector<CharacterEnding> endings_;
  std::jthread thread_;
};

/// The hash of each frame that a daemon casts which has a process for itself.
std::vector<uint64_t> hashesOfOwnDaemon(const CharacterSettings& character, uint64_t frames) {
  const std::atomic<bool> stop{false};
  auto [publisher, subscriber] = makeInProcessChannel(character.settings.groom_id);
  Daemon daemon(character.settings, makeScene(character.settings.scene), *publisher, newSession());
  daemon.announce();
  std::vector<uint64_t> hashes;
  while (hashes.size() < frames) {
    daemon.castFrame(stop);
    hashes.push_back(positionsHash(subscriber->frame()->positions));
  }
  return hashes;
}

TEST_F(StageTest, TenHeadsMoveAsTheyDoInTenDaemons) {
  constexpr uint32_t kHeads = 10;
  constexpr uint64_t kFrames = 200;
  std::vector<CharacterSettings> characters;
  for (uint32_t id = 1; id <= kHeads; ++id) {
    characters.push_back(character(id));
    characters.back().record = folder_ / (std::to_string(id) + ".rec");
  }
  start(characters);
  for (uint32_t id = 1; id <= kHeads; ++id) ASSERT_TRUE(waitForFrames(id, kFrames)) << id << log();
  const std::vector<CharacterEnding> endings = end();
  ASSERT_EQ(endings.size(), kHeads);
  for (uint32_t id = 1; id <= kHeads; ++id) {
    SCOPED_TRACE(id);
    const CharacterEnding& ending = endings[id - 1];
    EXPECT_EQ(ending.failure, "");
    EXPECT_EQ(ending.recording_failure, "");
    ASSERT_TRUE(ending.summary);
    EXPECT_EQ(ending.summary->status.non_finite, 0u);
    EXPECT_EQ(ending.summary->status.strands_reset, 0u);
    const std::vector<uint64_t> own = hashesOfOwnDaemon(characters[id - 1], kFrames);
    Recording recording(characters[id - 1].record);
    ASSERT_GE(recording.frames(), kFrames);
    RecordedFrame read;
    for (uint64_t frame = 0; frame < kFrames; ++frame) {
      recording.read(frame, read);
      ASSERT_EQ(read.record.state_hash, own[frame]) << "frame " << frame;
    }
  }
}

TEST_F(StageTest, WhoFailsToLoadIsToldInOneLineWhileTheOthersCast) {
  std::vector<CharacterSettings> characters{character(1), character(2), character(3)};
  characters[1].name = "ada";
  characters[1].settings.scene.groom = {folder_ / "missing.tfx"};
  start(characters);
  EXPECT_TRUE(waitForFrames(1, 20));
  EXPECT_TRUE(waitForFrames(3, 20));
  const std::vector<CharacterEnding> endings = end();
  EXPECT_NE(endings[1].failure.find("missing.tfx"), std::string::npos) << endings[1].failure;
  EXPECT_FALSE(endings[1].summary);
  EXPECT_EQ(linesOfLog("missing.tfx"), 1u) << log();
  EXPECT_EQ(linesOfLog("ada: "), 1u) << log();
  EXPECT_EQ(linesOfLog("[error]"), 1u) << log();
  for (const size_t i : {0u, 2u}) {
    EXPECT_EQ(endings[i].failure, "");
    ASSERT_TRUE(endings[i].summary);
    EXPECT_GE(endings[i].summary->status.frames, 20u);
  }
}

TEST_F(StageTest, ACommandEndsOneCharacterAlone) {
  start({character(1), character(2)});
  ASSERT_TRUE(waitForFrames(1, 5));
  reader(1).send({.id = 7, .kind = CommandKind::kShutdown, .name = "", .values = {}});
  EXPECT_EQ(reader(1).waitForAnswer(7, 10s).value_or("no answer"), "");
  for (int i = 0; i < 2000 && linesOfLog("groom 1: ended") == 0; ++i) std::this_thread::sleep_for(5ms);
  const auto then = reader(2).frame();
  ASSERT_TRUE(then);
  EXPECT_TRUE(waitForFrames(2, then->frame + 20));
  const std::vector<CharacterEnding> endings = end();
  EXPECT_EQ(endings[0].failure + endings[1].failure, "");
  EXPECT_EQ(linesOfLog("groom 1: ended"), 1u) << log();
  EXPECT_EQ(linesOfLog("groom 2: ended"), 0u) << log();
}

TEST_F(StageTest, ARecordedCharacterIsSimulatedAgainAlone) {
  const std::filesystem::path config = folder_ / "cast.toml";
  std::ofstream(config) << "scene = \"curly\"\n[groom]\nstrands = 20\nvertices = 8\n"
                           "[[character]]\ngroom_id = 1\nrecord = \"one.rec\"\n"
                           "[[character]]\ngroom_id = 2\nmotion = \"shake\"\nrecord = \"two.rec\"\n"
                           "[character.groom]\nstrands = 30\n";
  const std::vector<std::string> words{"--config", config.string(), "--backend", "simd"};
  CLI::App app;
  const SettingsOptions options(app, SettingsUse::kServe);
  app.parse(std::vector<std::string>(words.rbegin(), words.rend()));
  expectError([&] { options.resolve(); }, {"by strandcastd alone", "cast.toml line 5"});
  start(options.resolveCharacters(),
        [&](uint32_t groom_id, const std::string& backend, const std::string& device) {
          return simulationSource(words, options, backend, device, groom_id);
        });
  for (const uint32_t id : {1, 2}) ASSERT_TRUE(waitForFrames(id, 20));
  for (const CharacterEnding& ending : end()) EXPECT_EQ(ending.failure + ending.recording_failure, "");
  const std::atomic<bool> stop{false};
  for (const char* const name : {"one.rec", "two.rec"}) {
    Recording recording(folder_ / name);
    const ResimulationReport report = resimulate(recording, name, stop, [](uint64_t, Simulation&) {});
    EXPECT_GE(report.frames, 20u) << name;
    EXPECT_EQ(report.different, 0u) << name;
  }
}

TEST_F(StageTest, StatusesNameTheBudgetOfACharacter) {
  std::vector<CharacterSettings> two = {character(1), character(2)};
  two[1].budget_ms = 7;
  start(two);
  for (const uint32_t groom_id : {1, 2}) ASSERT_TRUE(waitForFrames(groom_id, 3));
  const std::vector<CharacterEnding> endings = end();
  ASSERT_EQ(endings.size(), 2u);
  for (const CharacterEnding& ending : endings) {
    ASSERT_TRUE(ending.summary);
    const double budget = namedValues(ending.summary->status.metrics).at("budget_ms");
    EXPECT_DOUBLE_EQ(budget, ending.groom_id == 2 ? 7 : 10) << "an equal share of two processors at 100 Hz";
  }
  start({character(3)});
  ASSERT_TRUE(waitForFrames(3, 3));
  const std::vector<CharacterEnding> alone = end();
  ASSERT_TRUE(alone.at(0).summary);
  EXPECT_EQ(namedValues(alone[0].summary->status.metrics).at("budget_ms"), 0);
}

TEST(Characters, OptionsHoldForAllAndWhatWouldBeOnesAloneIsRefused) {
  const std::filesystem::path config =
      std::filesystem::temp_directory_path() / ("strandcast_cast_" + std::to_string(getpid()) + ".toml");
  std::ofstream(config) << "[daemon]\nrate = 30\n[[character]]\ngroom_id = 1\n"
                           "[[character]]\nname = \"ada\"\ngroom_id = 2\n[character.daemon]\nrate = 90\n"
                           "[character.transport]\nlcm_url = \"file:///tmp/ada.log?mode=w\"\n";
  const auto resolved = [&](std::vector<std::string> words) {
    CLI::App app;
    const SettingsOptions options(app, SettingsUse::kServe);
    words.insert(words.end(), {"--config", config.string()});
    app.parse(std::vector<std::string>(words.rbegin(), words.rend()));
    return options.resolveCharacters();
  };
  const std::vector<CharacterSettings> cast = resolved({"--rate", "50", "--transport", "lcm"});
  ASSERT_EQ(cast.size(), 2u);
  for (const CharacterSettings& character : cast) {
    EXPECT_EQ(character.settings.rate, 50);
    EXPECT_EQ(character.settings.transport, "lcm");
  }
  expectError([&] { resolved({}); }, {"character ada: DDS has no URL", "line 11", "transport.lcm_url"});
  expectError([&] { resolved({"--groom-id", "3"}); }, {"its own groom_id: --groom-id"});
  expectError(
      [&] {
        resolved({"--transport", "lcm", "--lcm-url", "file:///tmp/a.log?mode=w"});
      },
      {"groom 1 and ada write one LCM log: file:///tmp/a.log"});
  std::filesystem::remove(config);
}

// The machine of the tests may have other work: the margin is wide. rate_budget_test.cc has the rule alone.
TEST_F(StageTest, NineLightHeadsGoOnBesideAHeavyOne) {
  if (kSanitized) GTEST_SKIP() << "sanitizers make light heads heavy";
  constexpr uint32_t kHeads = 10;
  constexpr double kShowRate = 20, kSeconds = 4;
  std::vector<CharacterSettings> characters;
  for (uint32_t id = 1; id <= kHeads; ++id) {
    characters.push_back(character(id));
    characters.back().settings.rate = kShowRate;
    characters.back().settings.duration = kSeconds;
  }
  characters[0].settings.scene.strands = 2000;  // a hundred times the others', five steps a frame
  start(characters);
  for (uint32_t id = 1; id <= kHeads; ++id) ASSERT_TRUE(waitForFrames(id, 1)) << log();
  std::this_thread::sleep_for(std::chrono::duration<double>(kSeconds + 1));
  const std::vector<CharacterEnding> endings = end();
  ASSERT_TRUE(endings[0].summary);
  const DaemonSummary& heavy = *endings[0].summary;
  for (uint32_t id = 2; id <= kHeads; ++id) {
    SCOPED_TRACE(id);
    ASSERT_TRUE(endings[id - 1].summary);
    const DaemonSummary& light = *endings[id - 1].summary;
    EXPECT_GE(static_cast<double>(light.status.frames), 0.7 * kShowRate * kSeconds);
    EXPECT_GE(light.status.frames, heavy.status.frames);
  }
  EXPECT_GT(heavy.status.frames, 0u);
}

TEST(Machine, IsSharedEvenly) {
  std::vector<CharacterSettings> characters(4);
  characters[1].budget_ms = 7;
  characters[1].settings.threads = 3;
  characters[2].settings.threads = 4;
  characters[3].settings.rate = 100;
  std::vector<CharacterSettings> few = characters, one(1);
  shareMachine(characters, 2);
  EXPECT_EQ(characters[0].settings.threads, 1);
  EXPECT_EQ(characters[0].settings.codec.threads, 1);
  EXPECT_DOUBLE_EQ(characters[0].budget_ms, 1000.0 / 60 / 2);
  EXPECT_EQ(characters[1].settings.threads, 3) << "what is given stays";
  EXPECT_EQ(characters[1].budget_ms, 7);
  EXPECT_DOUBLE_EQ(characters[2].budget_ms, 1000.0 / 60 / 2 / 4) << "of each of its threads";
  EXPECT_DOUBLE_EQ(characters[3].budget_ms, 5);
  shareMachine(few, 9);
  EXPECT_EQ(few[0].settings.threads, 2);
  EXPECT_DOUBLE_EQ(few[0].budget_ms, 1000.0 / 60) << "more processors than characters";
  shareMachine(one, 2);
  EXPECT_EQ(one[0].settings.threads, 0) << "one alone has all";
  EXPECT_EQ(one[0].budget_ms, 0);
}

}  // namespace
}  // namespace strandcast
