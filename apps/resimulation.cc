#include "apps/resimulation.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <deque>
#include <nlohmann/json.hpp>

#include "apps/channel.h"
#include "apps/console.h"
#include "apps/daemon.h"
#include "core/error.h"
#include "transport/recording/recorder.h"

namespace strandcast {
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
    Source out{options.resolve(source.at("config").get<std::string>()), source.at("device"), {}};
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
    inputs_.assign(next_.inputs.begin(), next_.inputs.end());
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
    inputs_.assign(next_.inputs.begin(), next_.inputs.end());
  }
  void publishStatus(const Status&) override {}
  uint32_t matchedReaders() const override { return 0; }
  EncodingReport encoding() const override { return {}; }
  std::optional<ConflictingDaemon> conflict() const override { return std::nullopt; }

  uint64_t session() const { return next_.frame->session; }
  double time() const { return next_.frame->simulation_time; }
  bool isOver() const { return is_over_; }

 private:
  Recording& recording_;
  const std::string& name_;
  ResimulationReport& report_;
  RecordedFrame next_;
  std::deque<Command> inputs_;
  bool is_over_ = false;
};

}  // namespace

std::string simulationSource(const std::vector<std::string>& words, const SettingsOptions& options,
                             const std::string& backend, const std::string& device) {
  const std::string config = options.config().empty() ? "" : configText(options.config());
  nlohmann::json arguments = nlohmann::json::array();
  for (const std::string& word : words) arguments.push_back(jsonOfBytes(word));
  return jsonText({{"arguments", arguments},
                   {"folder", jsonOfBytes(std::filesystem::current_path().string())},
                   {"config", config},
                   {"backend", backend},
                   {"device", device}});
}

ResimulationReport resimulate(Recording& recording, const std::string& name, const std::atomic<bool>& stop,
                              const std::function<void(uint64_t frames, Simulation&)>& frame_done) {
  if (recording.frames() == 0) throw Error("the recording has no frames", name, "");
  Source source = sourceOf(recording.head().source, name);
  ResimulationReport report;
  RecordedInputs inputs(recording, name, report);
  Daemon daemon(source.settings, std::move(source.scene), inputs, inputs.session());
  daemon.waitForBodies();
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
