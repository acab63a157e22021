#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>

#include "core/error.h"
#include "options/console.h"
#include "options/number_range.h"
#include "options/scene_loading.h"
#include "options/settings.h"
#include "service/daemon.h"
#include "service/network.h"
#include "service/recorded_air.h"
#include "service/replay.h"
#include "transport/recording/record_file.h"
#include "transport/recording/recorder.h"

using namespace strandcast;

namespace {

void report(const DaemonSummary& summary, bool json) {
  const Status& s = summary.status;
  Report out;
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
  if (const PoseMetrics& poses = summary.poses; poses.samples > 0) {
    out.addCount("pose_samples", "samples of live poses", poses.samples);
    out.addCount("pose_late", "of them late", poses.late);
    out.addCount("pose_lost", "lost", poses.lost);
    out.addCount("pose_jumps", "jumps of live poses", poses.jumps);
    out.addCount("pose_relocks", "clocks of live poses set", poses.relocks);
    out.addCount("pose_interpolated", "steps between samples", poses.interpolated);
    out.addCount("pose_extrapolated", "steps after the last sample", poses.extrapolated);
    out.addCount("pose_rested", "steps at rest after it", poses.rested);
    out.add("pose_latency_ms_p50", "latency of live poses, median", poses.latency_ms_p50, "ms", 2);
    out.add("pose_latency_ms_p99", "latency of live poses, 99th percentile", poses.latency_ms_p99, "ms", 2);
  }
  out.print(json);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "strandcastd simulates a head of hair and publishes its guide strands on the network.\n"
      "Draw it elsewhere with `strandcast render` or `strandcast view`; steer it with `strandcast ctl`.\n"
      "Sources of wind (fans, turbines) are given by [[wind]] tables of a --config file, or by `strandcast "
      "ctl fan`.\n"
      "\n"
      "Examples:\n"
      "  strandcastd --scene curly\n"
      "  strandcastd --groom bob.tfx --body head.obj --unit-meters 1 --motion shake --duration 10");
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
    Settings settings = options.resolve();
    if (claims->count() > 0) {
      settings.claim = claim;
      settings.given["claim"] = "--claim";
      checkUnusedNetworkSettings(settings);
    }
    if (!settings.collider_folder.empty() && !std::filesystem::is_directory(settings.collider_folder))
      throw Error("the collider folder is not there", settings.collider_folder.string(),
                  "name a folder of meshes (--collider-folder)");
    const uint64_t session = newSession();
    GroomClaim groom(settings,
                     session);  // conflicting daemons hear each other while the scene is loaded
    std::unique_ptr<Publisher> publisher = groom.take();
    Scene scene = makeSceneWithProgress(settings.scene, [&] { groom.check(); });
    RecordingPublisher* recording = nullptr;
    if (!file.empty()) {
      auto recorded = std::make_unique<RecordingPublisher>(std::move(publisher));
      recording = recorded.get();
      publisher = std::move(recorded);
    }
    Daemon daemon(settings, std::move(scene), *publisher, session);
    groom.await();
    if (recording != nullptr) {
      const std::vector<std::string> words(argv + 1, argv + argc);
      if (settings.claim)
        spdlog::warn(
            "{} can be replayed but not simulated again: a shared groom is the work of several daemons",
            file.string());
      recording->open(file, {settings.groom_id, settings.codec,
                             settings.claim ? ""
                                            : simulationSource(words, options, daemon.status().backend,
                                                               daemon.status().device)});
    }
    if (grids_every > 0) daemon.setObserver(gridRecorder(*recording, grids_every));
    if (g_interrupted) throw Interrupted();
    daemon.announce();
    spdlog::info("{} groom {} on {} at {:g} frames/s; Ctrl-C ends it",
                 settings.claim ? "sharing" : "publishing", settings.groom_id, networkName(settings),
                 settings.rate);
    const DaemonSummary summary = daemon.run(g_interrupted);
    const std::string failure = recording != nullptr ? recording->close() : "";
    const bool is_kept = failure.empty() && publisher->failure().empty();
    report(summary, json);
    if (grids_every > 0) warnWithoutGrids(recording->recorder());
    if (!failure.empty()) spdlog::error("{}", failure);
    if (!summary.failure.empty()) {
      spdlog::error("{}", summary.failure);
      return kExitBadInput;
    }
    if (g_interrupted) return kExitInterrupted;
    return is_kept ? 0 : kExitCheckFailed;
  });
}
