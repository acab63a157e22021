#include "service/replay.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <deque>
#include <thread>

#include "core/error.h"
#include "options/console.h"
#include "options/scene_loading.h"
#include "service/commands.h"
#include "service/daemon.h"
#include "transport/commands.h"
#include "transport/frame_queue.h"
#include "transport/parameter_table.h"
#include "transport/recording/recorder.h"

namespace strandcast {
namespace {

using Clock = std::chrono::steady_clock;
constexpr double kPollInterval = 0.004;  // s, between polls for commands
constexpr double kStillInterval = 0.25;  // s: interval at which a still frame is repeated for late joiners
constexpr double kMovedInterval = 1.0 / 60;  // s, between frames that are not consecutive

constexpr double kMaxDelay = 0.1;  // s, delay beyond which the schedule restarts

Clock::duration durationOf(double seconds) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

double numberOf(const Command& command, double low, double high) {
  if (command.values.size() != 1 || !(command.values[0] >= low && command.values[0] <= high))
    throw Error("out of range", command.name, fmt::format("give one number, {:g} to {:g}", low, high));
  return command.values[0];
}

}  // namespace

void checkReplay(const Recording& recording, const ReplayOptions& options) {
  if (recording.frames() > 0 && options.from <= recording.seconds()) return;
  const double end = options.to > 0 ? options.to : recording.seconds();
  throw Error("the range has no frames: nothing to replay", fmt::format("{:g} to {:g} s", options.from, end),
              fmt::format("the recording has {} frames, {:.3f} s", recording.frames(), recording.seconds()));
}

Replay::Replay(Recording& recording, Publisher& publisher, uint32_t groom_id, uint64_t session,
               const ReplayOptions& options)
    : recording_(recording), publisher_(publisher), conflict_detector_(groom_id), options_(options) {
  frame_.groom_id = status_.groom_id = groom_id;
  frame_.session = status_.session = session;
  status_.backend = "replay";
}

void Replay::apply(const Command& command) {
  switch (command.kind) {
    case CommandKind::kSetParameter:
      if (command.name == "speed") {
        const double speed = numberOf(command, 0, kMaxReplaySpeed);
        if (!isReplaySpeed(speed))
          throw Error("out of range", command.name,
                      fmt::format("give 0, or one number, {:g} to {:g}", kMinReplaySpeed, kMaxReplaySpeed));
        options_.speed = speed;
      } else if (command.name == "position") {
        target_ = numberOf(command, 0, std::max(end(), options_.from));
      } else if (command.name == "loop") {
        options_.loops = numberOf(command, 0, 1) > 0;
      } else {
        break;
      }
      return;
    case CommandKind::kReset:
      target_ = options_.from;
      return;
    case CommandKind::kShutdown:
      shutdown_ = true;
      return;
    case CommandKind::kHeadPose:
    case CommandKind::kHeadMotion:
    case CommandKind::kPause:
    case CommandKind::kStep:
    case CommandKind::kPull:
    case CommandKind::kAddCollider:
    case CommandKind::kMoveCollider:
    case CommandKind::kRemoveCollider:
    case CommandKind::kAddWindSource:
    case CommandKind::kMoveWindSource:
    case CommandKind::kRemoveWindSource:
    case CommandKind::kAddColliderFile:
      break;
  }
  throw Error("a replayed recording does not obey this command", commandText(command),
              "use set speed, set position, set loop, reset or stop");
}

void Replay::fillStatus() {
  status_.parameters = parameterTable(NamedValues{{"speed", {options_.speed}},
                                                  {"position", {target_.value_or(read_.record.time)}},
                                                  {"loop", {options_.loops ? 1.0 : 0.0}}});
}

void Replay::execute(const Command& command) {
  answerCommand(
      command, [&] { apply(command); }, status_);
  fillStatus();
  publisher_.publishStatus(status_);
}

void Replay::show(uint64_t number, double elapsed) {
  number_ = number;
  try {
    recording_.read(number, read_);
    for (const std::string& warning : recording_.warningsOf(read_.damage)) {
      if (std::find(warnings_.begin(), warnings_.end(), warning) != warnings_.end()) continue;
      spdlog::warn("{}", warning);
      warnings_.push_back(warning);
    }
    publish(elapsed);
  } catch (const Error& error) {
    if (summary_.damaged++ == 0) spdlog::warn("{}", error.what());
  }
}

void Replay::publish(double elapsed) {
  if (read_.groom != announced_) {
    GroomDescription groom = *read_.groom;
    BodyDescription body = *read_.body;
    groom.groom_id = body.groom_id = frame_.groom_id;
    groom.session = body.session = frame_.session;
    groom.revision = ++revision_;
    publisher_.announce(groom, body);
    if (read_.hairs) publisher_.announceHairs(*read_.hairs);
    announced_ = read_.groom;
    frame_.revision = revision_;
    status_.groom_name = groom.name;
    status_.strands = groom.guides.strands();
    status_.vertices = groom.guides.vertices();
  }
  ++frame_.frame;
  // Simulation time advances as a viewer sees it: at twice the speed, half the time per frame.
  frame_.simulation_time += elapsed;
  frame_.publish_time = systemTime();
  frame_.continuity = read_.frame->continuity;
  frame_.head = read_.frame->head;
  frame_.positions = read_.frame->positions;
  publisher_.publish(frame_);
  status_.frames = ++summary_.frames;
}

void Replay::publishStatus() {
  status_.simulation_time = read_.record.time;
  status_.readers = publisher_.matchedReaders();
  status_.encoding = publisher_.encoding();
  fillStatus();
  publisher_.publishStatus(status_);
  summary_.failure =
      conflict_detector_.check(publisher_, status_.session, status_.frames, Clock::now() - cast_since_)
          .value_or("");
}

ReplaySummary Replay::run(const std::atomic<bool>& stop) {
  checkReplay(recording_, options_);
  const Clock::time_point start = Clock::now();
  Clock::time_point shown = start, status_due = start;
  target_ = options_.from;
  cast_since_ = start;
  while (!stop && !shutdown_ && summary_.failure.empty()) {
    for (size_t taken = 0; taken < kMaxCommandsPerFrame; ++taken) {
      const std::optional<Command> command = publisher_.takeCommand();
      if (!command) break;
      execute(*command);
    }
    const double waited = secondsSince(shown), speed = options_.speed;
    const uint64_t next = number_ + 1;
    double due = kStillInterval;  // s after the frame that is shown
    if (target_) {
      show(recording_.frameAt(*target_), std::max(waited, kMovedInterval));
      target_.reset();
      shown = Clock::now();
      continue;
    }
    if (speed == 0) {
      if (waited >= due) {
        show(number_, waited);
        shown = Clock::now();
      }
    } else if (next >= recording_.frames() || recording_.timeOf(next) > end()) {
      due = kMovedInterval;
      if (waited >= due && !options_.loops) break;
      if (waited >= due) target_ = options_.from;
    } else {
      due = (recording_.timeOf(next) - recording_.timeOf(number_)) / speed;
      if (waited >= due) {
        show(next, due);
        // A machine that is too slow falls behind; it does not hurry afterwards.
        shown = waited > due + kMaxDelay ? Clock::now() : shown + durationOf(due);
      }
    }
    if (Clock::now() >= status_due) {
      publishStatus();
      status_due = Clock::now() + durationOf(kStatusInterval);
    }
    // Clamp seconds before converting: the gap after a recorded pause may exceed the clock's range.
    std::this_thread::sleep_for(durationOf(std::clamp(due - secondsSince(shown), 0.0, kPollInterval)));
  }
  publishStatus();
  summary_.seconds = secondsSince(start);
  return summary_;
}

namespace {

struct Source {
  Settings settings;
  std::string device;
  Scene scene;
};

/// Changes the working directory for its lifetime.
class Visit {
 public:
  explicit Visit(const std::filesystem::path& folder) : home_(std::filesystem::current_path()) {
    std::error_code gone;
    std::filesystem::current_path(folder, gone);  // a later failure to open a file names what is missing
  }
  ~Visit() {
    std::error_code gone;
    std::filesystem::current_path(home_, gone);
  }
  Visit(const Visit&) = delete;
  Visit& operator=(const Visit&) = delete;

 private:
  const std::filesystem::path home_;
};

/// JSON text is UTF-8, file names are any bytes: a name that is not UTF-8 becomes a list of its bytes.
nlohmann::json jsonOfBytes(const std::string& bytes) {
  nlohmann::json text = bytes;
  try {
    (void)text.dump();
  } catch (const nlohmann::json::type_error&) {
    text = std::vector<uint8_t>(bytes.begin(), bytes.end());
  }
  return text;
}
std::string bytesOfJson(const nlohmann::json& text) {
  if (text.is_string()) return text;
  const std::vector<uint8_t> bytes = text;
  return {bytes.begin(), bytes.end()};
}

/// The settings that the recorded source gives with its arguments.
Settings settingsOf(const nlohmann::json& source, const SettingsOptions& options, const std::string& name) {
  const std::string config = source.at("config");
  const uint32_t character = source.value("character", 0u);
  if (character == 0) return options.resolve(config);
  for (CharacterSettings& of_file : options.resolveCharacters(config))
    if (of_file.settings.groom_id == character) return std::move(of_file.settings);
  throw Error("the recorded settings are damaged", name, fmt::format("they lack groom {}", character));
}

Source sourceOf(const std::string& text, const std::string& name) {
  if (text.empty())
    throw Error("the recording has no settings to simulate from", name,
                "only recordings of `strandcastd --record` can be simulated again");
  try {
    const nlohmann::json source = nlohmann::json::parse(text);
    const Visit visit(bytesOfJson(source.at("folder")));  // relative file names start there
    CLI::App app;
    SettingsOptions options(app, SettingsUse::kServe);
    app.allow_extras();  // --record, --quiet and the like
    std::vector<std::string> words;
    for (const nlohmann::json& word : source.at("arguments")) words.push_back(bytesOfJson(word));
    std::reverse(words.begin(), words.end());  // CLI11 takes them in reverse order
    app.parse(words);
    Source out{settingsOf(source, options, name), source.at("device"), {}};
    out.settings.backend = source.at("backend");
    out.settings.duration = 0;
    out.scene = makeSceneWithProgress(out.settings.scene);
    return out;
  } catch (const CLI::ParseError& error) {
    throw Error(std::string("the recorded settings cannot be read: ") + error.what(), name,
                "use the version that recorded it");
  } catch (const nlohmann::json::exception& error) {
    throw Error("the recorded settings are damaged", name, error.what());
  }
}

/// Stands in for a network: supplies the recorded commands and compares frames.
class RecordedInputs final : public Publisher {
 public:
  RecordedInputs(Recording& recording, const std::string& name, ResimulationReport& report)
      : recording_(recording), name_(name), report_(report) {
    recording_.read(0, next_);
    takeInputs();
  }
  void announce(const GroomDescription& groom, const BodyDescription&) override {
    if (groom.guides.offsets != next_.groom->guides.offsets ||
        groom.guides.positions != next_.groom->guides.positions)
      throw Error("the groom differs from the recorded groom", name_,
                  "have its files changed, or is this another version of the program?");
  }
  void announceColliders(const ColliderSet&) override {}
  std::optional<Command> takeCommand() override {
    if (inputs_.empty()) return std::nullopt;
    Command command = std::move(inputs_.front());
    inputs_.pop_front();
    ++report_.inputs;
    return command;
  }
  void publish(const GuideFrame& frame) override {
    if (frame.frame < next_.frame->frame) return;  // the frame was not recorded
    ++report_.frames;
    if (positionsHash(frame.positions) != next_.record.state_hash && report_.different++ == 0)
      report_.first_different = next_.record.number;
    const uint64_t number = next_.record.number + 1;
    is_over_ = number == recording_.frames();
    if (is_over_) return;
    recording_.read(number, next_);
    is_over_ = next_.frame->session != frame.session;
    takeInputs();
  }
  void publishStatus(const Status&) override {}
  uint32_t matchedReaders() const override { return 0; }
  EncodingReport encoding() const override { return {}; }
  std::optional<ConflictingDaemon> conflict() const override { return std::nullopt; }

  /// The poses that live sources gave to a step.
  std::optional<StepPoses> poses(uint64_t step) {
    while (!poses_.empty() && poses_.front().step < step) poses_.pop_front();
    if (poses_.empty() || poses_.front().step != step) return std::nullopt;
    StepPoses poses = std::move(poses_.front());
    poses_.pop_front();
    return poses;
  }
  uint64_t session() const { return next_.frame->session; }
  double time() const { return next_.frame->simulation_time; }
  bool isOver() const { return is_over_; }

 private:
  void takeInputs() {
    if (next_.damage.pose_names)
      throw Error("the recording cannot be simulated again: names of its poses are damaged", name_,
                  "replay it without --resimulate");
    inputs_.assign(next_.inputs.begin(), next_.inputs.end());
    poses_.assign(next_.poses.begin(), next_.poses.end());
  }

  Recording& recording_;
  const std::string& name_;
  ResimulationReport& report_;
  RecordedFrame next_;
  std::deque<Command> inputs_;
  std::deque<StepPoses> poses_;
  bool is_over_ = false;
};

}  // namespace

std::string simulationSource(const std::vector<std::string>& words, const SettingsOptions& options,
                             const std::string& backend, const std::string& device, uint32_t character) {
  const std::string config = options.config().empty() ? "" : configText(options.config());
  nlohmann::json arguments = nlohmann::json::array();
  for (const std::string& word : words) arguments.push_back(jsonOfBytes(word));
  nlohmann::json source = {{"arguments", arguments},
                           {"folder", jsonOfBytes(std::filesystem::current_path().string())},
                           {"config", config},
                           {"backend", backend},
                           {"device", device}};
  if (character != 0) source["character"] = character;
  return jsonText(source);
}

ResimulationReport resimulate(Recording& recording, const std::string& name, const std::atomic<bool>& stop,
                              const std::function<void(uint64_t frames, Simulation&)>& frame_done) {
  if (recording.frames() == 0) throw Error("the recording has no frames", name, "");
  Source source = sourceOf(recording.head().source, name);
  ResimulationReport report;
  RecordedInputs inputs(recording, name, report);
  Daemon daemon(source.settings, std::move(source.scene), inputs, inputs.session());
  daemon.waitForBodies();
  daemon.setRecordedPoses([&](uint64_t step) { return inputs.poses(step); });
  daemon.announce();
  report.backend = daemon.status().backend;
  report.device = daemon.status().device;
  report.recorded_device = source.device;
  daemon.setObserver([&](Simulation& simulation) { frame_done(report.frames, simulation); });
  // The frames' times determine how many steps each frame took.
  daemon.setStepping([&](const Simulation& simulation) { return simulation.time() < inputs.time(); });
  while (!inputs.isOver() && !stop && daemon.castFrame(stop)) {
  }
  return report;
}

}  // namespace strandcast
