#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>

#include <map>
#include <string>
#include <thread>

#include "core/error.h"
#include "options/console.h"
#include "options/number_range.h"
#include "options/settings.h"
#include "service/recorded_air.h"
#include "service/replay.h"
#include "service/stage.h"
#include "transport/metrics.h"
#include "transport/recording/record_file.h"

using namespace strandcast;

namespace {

void add(const DaemonSummary& summary, Report& out) {
  const Status& s = summary.status;
  out.add("groom", "groom", s.groom_name);
  out.add("backend", "backend", s.backend);
  out.add("device", "device", s.device);
  out.addCount("strands", "strands", s.strands);
  out.addCount("vertices", "vertices", s.vertices);
  out.add("seconds", "ran for", summary.seconds, "s", 1);
  out.add("simulated_seconds", "simulated", s.simulation_time, "s", 1);
  out.add("step_ms_median", "step, median", s.step_ms_median, "ms", 3);
  out.add("step_ms_p95", "step, 95th percentile", s.step_ms_p95, "ms", 3);
  out.addCount("frames_published", "frames published", s.frames);
  out.addCount("frames_late", "frames late", summary.late_frames);
  out.add("mean_stretch", "mean stretch", s.mean_stretch, "", 6);
  out.add("max_stretch", "max stretch", s.max_stretch, "", 6);
  out.add("max_penetration_m", "max penetration", s.max_penetration, "m", 6);
  out.addCount("non_finite", "non-finite vertices", s.non_finite);
  out.addCount("strands_reset", "strands reset", s.strands_reset);
  if (!s.encoding.codec.empty()) {
    out.add("codec", "codec", s.encoding.codec);
    out.addCount("bytes_per_frame", "bytes per frame", s.encoding.frame_bytes);
    out.add("codec_worst_error_mm", "worst error of the codec", 1e3 * s.encoding.worst_error, "mm", 4);
    out.addCount("strands_sent_finer", "strands sent finer", s.encoding.strands_sent_finer);
  }
  const std::map<std::string, double> metrics = namedValues(s.metrics);
  if (const auto samples = metrics.find("pose_samples"); samples == metrics.end() || samples->second == 0)
    return;
  for (const MetricInfo& info : metricList()) {
    if (*info.label == '\0') continue;
    const double value = metrics.at(info.name);
    if (info.is_counter)
      out.addCount(info.name, info.label, static_cast<uint64_t>(value));
    else
      out.add(info.name, info.label, value, info.unit, 2);
  }
}

/// Whether every character cast to its end, and kept its recording.
int exitCodeOf(const std::vector<CharacterEnding>& endings) {
  bool is_kept = true;
  for (const CharacterEnding& ending : endings) {
    if (!ending.failure.empty()) return kExitBadInput;
    is_kept = is_kept && ending.is_kept;
  }
  if (g_interrupted) return kExitInterrupted;
  return is_kept ? 0 : kExitCheckFailed;
}

void print(const std::vector<CharacterEnding>& endings, bool json) {
  std::string objects;
  for (const CharacterEnding& ending : endings) {
    Report out;
    out.add("character", "character", ending.character);
    out.addCount("groom_id", "groom id", ending.groom_id);
    if (!ending.failure.empty()) out.add("failure", "failure", ending.failure);
    if (ending.summary) add(*ending.summary, out);
    if (json) {
      objects += (objects.empty() ? "" : ", ") + out.json();
    } else {
      out.print(false);
      std::puts("");
    }
  }
  if (json) std::puts(fmt::format("{{\"characters\": [{}]}}", objects).c_str());
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "strandcastd simulates a head of hair and publishes its guide strands on the network.\n"
      "Draw it elsewhere with `strandcast render` or `strandcast view`; steer it with `strandcast ctl`.\n"
      "Sources of wind (fans, turbines) are given by [[wind]] tables of a --config file, or by `strandcast "
      "ctl fan`.\n"
      "Several characters in one process are tables [[character]] of a --config file (docs/reference.md).\n"
      "\n"
      "Examples:\n"
      "  strandcastd --scene curly\n"
      "  strandcastd --groom bob.tfx --body head.obj --unit-meters 1 --motion shake --duration 10\n"
      "  strandcastd --config docs/cast.toml");
  app.get_formatter()->column_width(34);
  SettingsOptions options(app, SettingsUse::kServe);
  bool json = false, quiet = false;
  std::filesystem::path file;
  CLI::Option* records = app.add_option(
      "--record", file,
      "also write groom, frames and commands to this file, replacing an old one when publishing starts: "
      "`strandcast replay FILE` publishes it again, `strandcast replay FILE --resimulate` simulates it again "
      "and compares every frame. Frames are written with --codec");
  uint32_t grids_every = 0;
  app.add_option("--record-grids", grids_every,
                 "also record the grids of air and hair (density, wind, pressure, divergence) of every Nth "
                 "frame, where settings use them: `strandcast replay FILE --show wind` draws them")
      ->transform(wholeRange(1, 1000000))
      ->needs(records);
  uint32_t claim = 0;
  const CLI::Option* claims =
      app.add_option("--claim", claim,
                     "share the groom with other daemons that claim it (DDS), of the same scene and options: "
                     "the daemon with the largest number publishes (of equals, the first); the others stand "
                     "by and take over within 0.5 s of its end (1 s for an equal number). A joining daemon "
                     "receives the show before it may take over")
          ->transform(wholeRange(0, 4294967295.0));
  app.add_flag("--json", json, "print the closing summary as one JSON object");
  app.add_flag("--quiet", quiet, "log warnings only");
  if (const std::optional<int> ended = parseArguments(app, argc, argv)) return *ended;
  spdlog::set_default_logger(spdlog::stderr_color_mt("strandcastd"));
  if (quiet) spdlog::set_level(spdlog::level::warn);

  return runProgram([&] {
    catchInterrupts();
    if (records->count() > 0 && file.empty())
      throw Error("the recording has no name", "--record ''", "name a file, e.g. --record run.rec");
    if (!file.empty()) RecordWriter::check(file);  // before the scene is made and the groom claimed
    const std::vector<std::string> words(argv + 1, argv + argc);
    const auto addClaim = [&](Settings& settings) {
      if (claims->count() == 0) return;
      settings.claim = claim;
      settings.given["claim"] = "--claim";
      checkUnusedNetworkSettings(settings);
    };

    std::vector<CharacterSettings> characters = options.resolveCharacters();
    if (!characters.empty()) {
      if (!file.empty())
        throw Error("each character has a recording of its own", "--record",
                    "name a file in its [[character]] table, e.g. record = \"ada.rec\"");
      for (CharacterSettings& character : characters)
        forCharacter(character, [&] { addClaim(character.settings); });
      shareMachine(characters, std::thread::hardware_concurrency());
      Stage stage(std::move(characters),
                  [&](uint32_t groom_id, const std::string& backend, const std::string& device) {
                    return simulationSource(words, options, backend, device, groom_id);
                  });
      const std::vector<CharacterEnding> endings = stage.run(g_interrupted);
      print(endings, json);
      return exitCodeOf(endings);
    }

    CharacterSettings only{options.resolve(), "", 0, file};
    addClaim(only.settings);
    Character character(only);
    character.load();
    if (grids_every > 0) character.daemon().setObserver(gridRecorder(*character.recording(), grids_every));
    character.announce([&](uint32_t, const std::string& backend, const std::string& device) {
      return simulationSource(words, options, backend, device);
    });
    const CharacterEnding ending = character.cast(g_interrupted);
    Report out;
    add(*ending.summary, out);
    out.print(json);
    if (grids_every > 0) warnWithoutGrids(character.recording()->recorder());
    for (const std::string& failure : {ending.recording_failure, ending.failure})
      if (!failure.empty()) spdlog::error("{}", failure);
    return exitCodeOf({ending});
  });
}
