#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <memory>

#include "apps/channel.h"
#include "apps/console.h"
#include "apps/interrupt.h"
#include "apps/stream_recording.h"
#include "apps/verbs.h"
#include "core/error.h"

namespace strandcast {
namespace {

struct Options {
  Settings network;
  std::filesystem::path file;
  std::string codec = "delta16";
  double codec_error_mm = 0.01;
  double seconds = 0;   // of simulation; 0 = until the stream ends
  double timeout = 20;  // s
  bool json = false;
};

int record(const Options& o) {
  const std::unique_ptr<Subscriber> subscriber = subscribe(o.network);
  RecordingOptions options;
  options.groom_id = o.network.groom_id;
  options.codec = {codecNamed(o.codec, "--codec"), static_cast<float>(1e-3 * o.codec_error_mm)};
  StreamRecording recording(*subscriber, o.file, options);
  const Recorder& recorder = recording.recorder();
  auto heard = std::chrono::steady_clock::now();
  {
    ProgressBar bar;
    while (!g_interrupted && (o.seconds == 0 || recorder.seconds() < o.seconds - 1e-6)) {
      const bool came = recording.take(std::chrono::milliseconds(100));
      const auto now = std::chrono::steady_clock::now();
      if (!came) {
        if (std::chrono::duration<double>(now - heard).count() > o.timeout) break;
        continue;
      }
      heard = now;
      bar.show(fmt::format("{:.1f} s, {:.1f} MB", recorder.seconds(),
                           1e-6 * static_cast<double>(recorder.bytes())),
               o.seconds > 0 ? recorder.seconds() / o.seconds : 0);
    }
  }
  recording.close();
  const uint64_t skipped = recording.skipped();
  if (recorder.frames() == 0 && !g_interrupted)
    throw Error("no frame came", fmt::format("groom {} on {}", o.network.groom_id, networkName(o.network)),
                "start strandcastd, or check --domain and --groom-id");
  const auto bytes = static_cast<double>(recorder.bytes());
  Report out;
  out.add("file", "recording", o.file.string());
  out.addCount("frames", "frames", recorder.frames());
  out.addCount("frames_skipped", "frames skipped", skipped);
  out.addCount("frames_concealed", "with concealed strands", subscriber->statistics().frames_concealed);
  out.add("seconds", "simulated", recorder.seconds(), "s", 3);
  out.add("megabytes", "size", 1e-6 * bytes, "MB", 3);
  out.print(o.json);
  if (skipped > 0)
    spdlog::warn("{} frames were lost on the way or came faster than they could be written", skipped);
  return g_interrupted ? kExitInterrupted : 0;
}

}  // namespace

Verb addRecord(CLI::App& app) {
  const auto o = std::make_shared<Options>();
  app.footer(
      "Records what a daemon casts, over any transport, until the stream ends, --seconds or Ctrl-C. Whatever "
      "ends "
      "it, the file can be replayed up to there. (`strandcastd --record FILE` also records the commands, so "
      "that "
      "`replay --resimulate` can repeat the simulation.)\n"
      "Examples:\n"
      "  strandcast record take1.rec --seconds 10\n"
      "  strandcast record exact.rec --codec float32\n"
      "  strandcast replay take1.rec --loop");
  app.add_option("FILE", o->file, "recording to write; an old one is replaced")->required();
  app.add_option("--seconds", o->seconds, "of simulation to record; 0 = until the stream ends")
      ->check(CLI::Range(0.0, 1e6));
  app.add_option(
         "--codec", o->codec,
         "how frames are written. delta16: about 3 bytes per vertex; tangent: smallest; float32: bit for bit")
      ->check(CLI::IsMember({"float32", "delta16", "oct12", "oct16", "tangent"}))
      ->capture_default_str();
  app.add_option("--codec-error", o->codec_error_mm, "mm; no vertex is written further from where it was")
      ->check(CLI::Range(0.001, 1.0))
      ->capture_default_str();
  app.add_option("--timeout", o->timeout, "seconds without a frame after which the stream has ended")
      ->check(CLI::Range(0.1, 3600.0))
      ->capture_default_str();
  app.add_flag("--json", o->json, "print the closing summary as one JSON object");
  addNetworkOptions(app, o->network);
  return [o] { return record(*o); };
}

}  // namespace strandcast
