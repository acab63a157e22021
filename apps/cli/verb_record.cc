#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <memory>

#include "apps/cli/verbs.h"
#include "core/error.h"
#include "options/console.h"
#include "options/number_range.h"
#include "options/scene_loading.h"
#include "service/daemon.h"
#include "service/network.h"
#include "service/recorded_air.h"
#include "service/stream.h"
#include "transport/in_process.h"
#include "transport/recording/recorder.h"

namespace strandcast {
namespace {

struct RecordOptions {
  std::unique_ptr<SettingsOptions> settings;
  std::filesystem::path file;
  uint32_t grids_every = 0;
  double seconds = 0;   // s of simulation time; 0 = until the stream ends
  double timeout = 20;  // s
  bool json = false;
};

constexpr double kRounding = 1e-6;  // s

/// Shows progress; true once the requested seconds are recorded.
bool isLongEnough(const Recorder& recorder, const RecordOptions& o, ProgressBar& bar) {
  bar.show(
      fmt::format("{:.1f} s, {:.1f} MB", recorder.seconds(), 1e-6 * static_cast<double>(recorder.bytes())),
      o.seconds > 0 ? recorder.seconds() / o.seconds : 0);
  return o.seconds > 0 && recorder.seconds() >= o.seconds - kRounding;
}

void addFile(Report& out, const Recorder& recorder, const RecordOptions& o) {
  out.add("file", "recording", o.file.string());
  out.addCount("frames", "frames", recorder.frames());
  if (o.grids_every > 0) out.addCount("grids", "frames with grids", recorder.gridFrames());
  out.add("seconds", "simulated", recorder.seconds(), "s", 3);
  out.add("megabytes", "size", 1e-6 * static_cast<double>(recorder.bytes()), "MB", 3);
}

RecordingOptions recordingOptions(const Settings& settings) {
  RecordingOptions options;
  options.groom_id = settings.groom_id;
  options.codec = settings.codec;
  if (settings.codec.codec == Codec::kTemporal)
    spdlog::warn("a recording holds key frames only: it is written with --codec oct12, not temporal");
  return options;
}

/// Simulates a scene as fast as this machine can and records every frame.
int simulateAndRecord(const RecordOptions& o, const Settings& settings) {
  // The listening end has no readers.
  auto [channel, listener] = makeInProcessChannel(settings.groom_id);
  RecordingPublisher publisher(std::move(channel), false);
  Daemon daemon(settings, makeSceneWithProgress(settings.scene), publisher, newSession());
  publisher.open(o.file, recordingOptions(settings));
  const Recorder& recorder = publisher.recorder();
  if (o.grids_every > 0) daemon.setObserver(gridRecorder(publisher, o.grids_every));
  if (g_interrupted) throw Interrupted();
  daemon.announce();
  const auto start = std::chrono::steady_clock::now();
  const auto isLate = [&] {
    const std::chrono::duration<double> ran = std::chrono::steady_clock::now() - start;
    return settings.duration > 0 && ran.count() >= settings.duration;
  };
  {
    ProgressBar bar;
    while (recorder.isOpen() && !isLate() && !isLongEnough(recorder, o, bar) &&
           daemon.castFrame(g_interrupted)) {
    }
  }
  const std::string failure = publisher.close();
  Report out;
  addFile(out, recorder, o);
  out.print(o.json);
  if (o.grids_every > 0) warnWithoutGrids(recorder);
  if (!failure.empty()) spdlog::error("{}", failure);
  if (g_interrupted) return kExitInterrupted;
  return failure.empty() ? 0 : kExitCheckFailed;
}

/// Records the frames of a daemon.
int recordStream(const RecordOptions& o, const Settings& settings) {
  if (o.grids_every > 0)
    throw Error("a daemon does not publish its grids", "--grids",
                "name what to simulate here, e.g. --scene straight, or let the daemon record: `strandcastd "
                "--record FILE --record-grids N`");
  const std::unique_ptr<Subscriber> subscriber = subscribe(settings);
  StreamRecording recording(*subscriber, o.file, recordingOptions(settings));
  const Recorder& recorder = recording.recorder();
  auto heard = std::chrono::steady_clock::now();
  {
    ProgressBar bar;
    while (!g_interrupted && !isLongEnough(recorder, o, bar)) {
      const bool came = recording.take(std::chrono::milliseconds(100));
      const auto now = std::chrono::steady_clock::now();
      if (came) heard = now;
      if (std::chrono::duration<double>(now - heard).count() > o.timeout) break;
    }
  }
  recording.close();
  const uint64_t skipped = recording.skipped();
  if (recorder.frames() == 0 && g_interrupted) {
    spdlog::warn("no frame arrived: {} is unchanged", o.file.string());
    return kExitInterrupted;
  }
  if (recorder.frames() == 0)
    throw Error("no frame arrived", fmt::format("groom {} on {}", settings.groom_id, networkName(settings)),
                "start strandcastd, or check --domain and --groom-id");
  Report out;
  addFile(out, recorder, o);
  out.addCount("frames_skipped", "frames skipped", skipped);
  out.addCount("frames_concealed", "with concealed strands", subscriber->statistics().frames_concealed);
  out.print(o.json);
  if (skipped > 0)
    spdlog::warn("{} frames were lost in transport or arrived faster than they could be written", skipped);
  if (g_interrupted) return kExitInterrupted;
  if (o.seconds == 0 || recorder.seconds() >= o.seconds - kRounding) return 0;
  spdlog::warn("the stream ended after {:.3f} of {:g} s", recorder.seconds(), o.seconds);
  return kExitCheckFailed;
}

int record(const RecordOptions& o) {
  const Settings settings = o.settings->resolve();
  o.settings->refuseWithoutScene();
  o.settings->warnOfUnusedNetwork();
  return o.settings->namesScene() ? simulateAndRecord(o, settings) : recordStream(o, settings);
}

}  // namespace

Verb addRecord(CLI::App& app) {
  const auto o = std::make_shared<RecordOptions>();
  app.footer(
      "Records the frames of a daemon, over any transport, until the stream ends, --seconds or Ctrl-C. With "
      "--scene, --groom or --config it simulates in this process instead, as fast as possible. However the "
      "recording ends, its frames up to then can be replayed; exit code 1 if the stream ended before "
      "--seconds. (`strandcastd --record FILE` also records the commands, so that `replay --resimulate` can "
      "repeat the simulation.)\n"
      "Examples:\n"
      "  strandcast record take1.rec --seconds 10\n"
      "  strandcast record exact.rec --codec float32\n"
      "  strandcast record air.rec --scene straight --set wind_grid=1 --seconds 2 --grids 6\n"
      "  strandcast replay take1.rec --loop");
  app.add_option("FILE", o->file, "recording to write; replaces an old one when the first frame arrives")
      ->required();
  app.add_option("--seconds", o->seconds,
                 "seconds of simulation to record; 0 = until the stream ends, or Ctrl-C")
      ->check(finiteRange(0.0, 1e6));
  app.add_option("--grids", o->grids_every,
                 "with a scene: also record the grids of air and hair (density, wind, pressure, divergence) "
                 "of every Nth frame; `strandcast replay FILE --show wind` draws them")
      ->transform(wholeRange(1, 1000000));
  app.add_option("--timeout", o->timeout, "seconds without a frame after which the stream has ended")
      ->check(finiteRange(0.1, 3600.0))
      ->capture_default_str();
  app.add_flag("--json", o->json, "print the closing summary as one JSON object");
  o->settings = std::make_unique<SettingsOptions>(app);
  return [o] { return record(*o); };
}

}  // namespace strandcast
