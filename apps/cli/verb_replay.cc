#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <set>
#include <string>

#ifdef STRANDCAST_HAS_RENDER
#include "service/slices.h"
#endif
#include "apps/cli/verbs.h"
#include "core/error.h"
#include "io/text_number.h"
#include "options/console.h"
#include "options/number_range.h"
#include "service/network.h"
#include "service/recorded_air.h"
#include "service/replay.h"
#include "transport/recording/recorder.h"

namespace strandcast {
namespace {

struct ReplayVerbOptions {
  Settings settings;
  std::filesystem::path file;
  std::string codec = nameOf(CodecOptions().codec);
  ReplayOptions replay;
  std::string show, slice = "z";
  std::filesystem::path out = "out";
  int size = 600;  // pixels
  double fps = 30;
  bool checks = false, resimulates = false, json = false;
};

CLI::Validator notTooSlow() {
  const auto refuse = [](const std::string& text) {
    const std::optional<double> speed = numberOf(text);
    if (speed && isReplaySpeed(*speed)) return std::string();
    return fmt::format("{} is too slow: give {:g} or more, or 0", text, kMinReplaySpeed);
  };
  return {refuse, ""};
}

void addFile(Report& out, const Recording& recording) {
  out.addCount("frames", "frames", recording.frames());
  out.add("seconds", "simulated", recording.seconds(), "s", 3);
  out.addCount("cut", "truncated or not closed", recording.isCut() ? 1 : 0);
  out.add("codec", "codec", recording.head().codec);
  out.add("codec_error_mm", "error of the codec, upper bound",
          1e3 * static_cast<double>(recording.head().max_error), "mm", 4);
  out.add("megabytes", "size", 1e-6 * static_cast<double>(recording.bytes()), "MB", 3);
}

int check(Recording& recording, const ReplayVerbOptions& o) {
  const bool is_exact = recording.head().max_error == 0;
  bool can_resimulate = !recording.head().source.empty() && recording.frames() > 0;
  uint64_t damaged = 0, different = 0, inputs = 0, grooms = 0, with_grids = 0;
  const GroomDescription* groom = nullptr;
  std::set<std::string> warnings;  // of damaged descriptions
  RecordedFrame read;
  AirGrids grids;
  {
    ProgressBar bar;
    for (uint64_t number = 0; number < recording.frames() && !g_interrupted; ++number) {
      try {
        recording.read(number, read);
        for (const std::string& warning : recording.warningsOf(read.damage))
          if (warnings.insert(warning).second) spdlog::warn("{}", warning);
        if (read.damage.pose_names) can_resimulate = false;
        if (is_exact && positionsHash(read.frame->positions) != read.record.state_hash) ++different;
        inputs += read.inputs.size();
        if (read.groom.get() != groom) ++grooms;
        groom = read.groom.get();
        if (recording.readGrids(number, grids)) ++with_grids;
      } catch (const Error& error) {
        if (damaged++ == 0) spdlog::warn("{}", error.what());
        if (number == 0) can_resimulate = false;  // resimulation starts from frame 0
      }
      bar.show(fmt::format("frame {} of {}", number + 1, recording.frames()),
               static_cast<double>(number + 1) / static_cast<double>(recording.frames()));
    }
  }
  Report out;
  addFile(out, recording);
  out.addCount("grooms", "grooms", grooms);
  out.addCount("inputs", "commands", inputs);
  out.addCount("grids", "frames with grids", with_grids);
  out.addCount("can_resimulate", "can be resimulated", can_resimulate ? 1 : 0);
  out.addCount("frames_damaged", "frames damaged", damaged);
  out.addCount("descriptions_damaged", "kinds of descriptions damaged", warnings.size());
  if (is_exact) out.addCount("frames_different", "frames with a different hash", different);
  out.print(o.json);
  if (g_interrupted) return kExitInterrupted;
  const bool is_whole = recording.frames() > 0 && !recording.isCut();
  return is_whole && damaged + different + warnings.size() == 0 ? 0 : kExitCheckFailed;
}

#ifdef STRANDCAST_HAS_RENDER
/// Draws grids at even times, and skips frames that do not hold the quantity on a grid.
class GridPictures {
 public:
  explicit GridPictures(const ReplayVerbOptions& o)
      : show_(o.show), fps_(o.fps), film_(o.show, o.slice, o.size, o.out) {}
  void draw(Simulation& simulation) {
    if (!isDue(simulation.time())) return;
    if (film_.canDraw(simulation))
      film_.draw(simulation);
    else
      ++without_;
  }
  void draw(double time, const AirGrids& grids, std::span<const Vec3> hair) {
    if (!isDue(time)) return;
    const RecordedAir air(grids);
    if (film_.canDraw(air))
      film_.draw(air, hair);
    else
      ++without_;
  }
  /// Throws Error where there were frames and none of them held the quantity.
  void checkDrawn() const {
    if (film_.drawn() == 0 && without_ > 0)
      throw Error(fmt::format("no frame of {} has this quantity on a grid", without_), "--show " + show_,
                  fmt::format("record a run with {}, or show something else", film_.settings()));
  }
  int drawn() const { return film_.drawn(); }
  void addTo(Report& out) const {
    film_.addTo(out);
    out.addCount("frames_without", fmt::format("frames without {} on a grid", show_),
                 static_cast<uint64_t>(without_));
  }

 private:
  bool isDue(double time) {
    if (!start_) start_ = time;
    constexpr double kEarly = 1e-9;  // s
    return time >= *start_ + static_cast<double>(film_.drawn() + without_) / fps_ - kEarly;
  }

  const std::string show_;
  const double fps_;
  AirFilm film_;
  std::optional<double> start_;  // s
  int without_ = 0;              // frames that held the quantity on no grid
};
#else
class GridPictures {
 public:
  explicit GridPictures(const ReplayVerbOptions& o) {
    throw Error("this build cannot draw", "--show " + o.show, "build with OpenGL");
  }
  void draw(Simulation&) {}
  void draw(double, const AirGrids&, std::span<const Vec3>) {}
  void checkDrawn() const {}
  int drawn() const { return 0; }
  void addTo(Report&) const {}
};
#endif

/// Draws the recorded grids.
int showGrids(Recording& recording, const ReplayVerbOptions& o) {
  GridPictures pictures(o);
  const double end = o.replay.to > 0 ? o.replay.to : recording.seconds();
  RecordedFrame read;
  AirGrids grids;
  {
    ProgressBar bar;
    for (uint64_t number = recording.frameAt(o.replay.from); number < recording.frames() && !g_interrupted;
         ++number) {
      const double time = recording.timeOf(number);
      if (time > end) break;
      if (recording.readGrids(number, grids)) {
        recording.read(number, read);
        pictures.draw(time, grids, read.frame->positions);
      }
      bar.show(fmt::format("frame {} of {}", number + 1, recording.frames()),
               static_cast<double>(number + 1) / static_cast<double>(recording.frames()));
    }
  }
  if (!g_interrupted) pictures.checkDrawn();
  if (pictures.drawn() == 0 && !g_interrupted)
    throw Error("the recording has no grids in this range", o.file.string(),
                "record them with `strandcastd --record FILE --record-grids 1`, or add --resimulate");
  Report out;
  addFile(out, recording);
  pictures.addTo(out);
  out.print(o.json);
  return g_interrupted ? kExitInterrupted : 0;
}

int simulateAgain(Recording& recording, const ReplayVerbOptions& o) {
  ResimulationReport report;
  std::optional<GridPictures> pictures;
  if (!o.show.empty()) pictures.emplace(o);
  {
    ProgressBar bar;
    report =
        resimulate(recording, o.file.string(), g_interrupted, [&](uint64_t frames, Simulation& simulation) {
          if (pictures) pictures->draw(simulation);
          bar.show(fmt::format("frame {} of {}", frames, recording.frames()),
                   static_cast<double>(frames) / static_cast<double>(recording.frames()));
        });
  }
  if (pictures && !g_interrupted) pictures->checkDrawn();
  Report out;
  if (pictures) pictures->addTo(out);
  out.add("backend", "backend", report.backend);
  out.add("device", "device", report.device);
  out.add("recorded_device", "recorded on", report.recorded_device);
  out.addCount("frames", "frames compared", report.frames);
  out.addCount("inputs", "commands repeated", report.inputs);
  out.addCount("frames_different", "frames that differ", report.different);
  if (report.different > 0) out.addCount("first_different", "first different frame", report.first_different);
  out.print(o.json);
  if (g_interrupted) return kExitInterrupted;
  return report.different == 0 ? 0 : kExitCheckFailed;
}

int cast(Recording& recording, const ReplayVerbOptions& o) {
  Settings settings = o.settings;
  settings.codec.codec = codecNamed(o.codec, "--codec");
  checkReplay(recording, o.replay);  // before subscribers hear of the replay
  const uint64_t session = newSession();
  const std::unique_ptr<Publisher> publisher = claimGroom(settings, session);
  Replay replay(recording, *publisher, settings.groom_id, session, o.replay);
  spdlog::info("replaying {:.1f} s as groom {} on {}; Ctrl-C ends it", recording.seconds(), settings.groom_id,
               networkName(settings));
  const ReplaySummary summary = replay.run(g_interrupted);
  Report out;
  addFile(out, recording);
  out.addCount("frames_published", "frames published", summary.frames);
  out.addCount("frames_damaged", "frames damaged", summary.damaged);
  out.add("wall_seconds", "ran for", summary.seconds, "s", 1);
  out.print(o.json);
  if (!summary.failure.empty()) {
    spdlog::error("{}", summary.failure);
    return kExitBadInput;
  }
  if (g_interrupted) return kExitInterrupted;
  return summary.damaged == 0 && publisher->failure().empty() ? 0 : kExitCheckFailed;
}

int replay(const ReplayVerbOptions& o) {
  if (o.replay.to > 0 && o.replay.to <= o.replay.from)
    throw Error("--to is not after --from", fmt::format("--from {:g} --to {:g}", o.replay.from, o.replay.to),
                "give a later --to");
  Recording recording(o.file);
  if (recording.isCut())
    spdlog::warn("{} is truncated or was not closed: {} frames, {:.1f} s can be read", o.file.string(),
                 recording.frames(), recording.seconds());
  if (o.resimulates) return simulateAgain(recording, o);
  if (!o.show.empty()) return showGrids(recording, o);
  return o.checks ? check(recording, o) : cast(recording, o);
}

}  // namespace

Verb addReplay(CLI::App& app) {
  const auto o = std::make_shared<ReplayVerbOptions>();
  app.footer(
      "Publishes a recording as a daemon publishes its simulation; renderers see no difference. While it "
      "runs, `strandcast ctl set speed 0` pauses it, `ctl set position 3.5` seeks to 3.5 s, `ctl set loop 1` "
      "loops it, `ctl reset` returns to --from, `ctl stop` ends it.\n"
      "Examples:\n"
      "  strandcast replay take1.rec --speed 0.25 --loop --from 2 --to 4\n"
      "  strandcast replay take1.rec --check            is it complete and every frame undamaged?\n"
      "  strandcastd --scene curly --duration 5 --record run.rec\n"
      "  strandcast replay run.rec --resimulate         is the simulation bit-identical?\n"
      "  strandcast replay run.rec --resimulate --show density --out slices\n"
      "  strandcast record air.rec --scene straight --set wind_grid=1 --seconds 2 --grids 6\n"
      "  strandcast replay air.rec --show wind --out slices");
  app.add_option("FILE", o->file, "recording, of `strandcast record` or `strandcastd --record`")->required();
  auto* speed =
      app.add_option("--speed", o->replay.speed,
                     fmt::format("speed relative to simulated time, {:g} or more; 0 pauses", kMinReplaySpeed))
          ->check(finiteRange(0.0, kMaxReplaySpeed))
          ->check(notTooSlow())
          ->capture_default_str();
  auto* loop = app.add_flag("--loop", o->replay.loops, "restart at the end");
  auto* from = app.add_option("--from", o->replay.from, "start, seconds of the recording")
                   ->check(finiteRange(0.0, 1e6));
  auto* to = app.add_option("--to", o->replay.to, "end, seconds of the recording; 0 = its end")
                 ->check(finiteRange(0.0, 1e6));
  auto* check =
      app.add_flag("--check", o->checks,
                   "publish nothing; read every frame and print the contents of the file. Exit "
                   "code 1 if a frame or what describes it is damaged, there is no frame, or the file "
                   "is truncated");
  auto* resimulate = app.add_flag("--resimulate", o->resimulates,
                                  "publish nothing; simulate again from the recorded settings and commands, "
                                  "on the same backend, and compare the hash of every frame")
                         ->excludes(check);
  for (CLI::Option* const of_all : {check, resimulate})  // they process every frame at full speed
    for (CLI::Option* const of_casting : {speed, loop, from, to}) of_all->excludes(of_casting);
  const char* const kGrids = "Grids of density and wind, as pictures";
  auto* show = app.add_option("--show", o->show,
                              "density, wind, pressure or divergence: publish nothing; draw slices through "
                              "the recorded grids (--record-grids) between --from and --to; with "
                              "--resimulate, through the grids of every simulated frame")
                   ->check(CLI::IsMember({"density", "wind", "pressure", "divergence"}))
                   ->excludes(check)
                   ->excludes(speed)
                   ->excludes(loop)
                   ->group(kGrids);
  app.add_option("--slice", o->slice, "axis perpendicular to the slice")
      ->check(CLI::IsMember({"x", "y", "z"}))
      ->needs(show)
      ->capture_default_str()
      ->group(kGrids);
  app.add_option("--out", o->out, "folder for frame_0000.png and following")
      ->needs(show)
      ->capture_default_str()
      ->group(kGrids);
  app.add_option("--size", o->size, "pixels along each edge")
      ->transform(wholeRange(16, 4096))
      ->needs(show)
      ->capture_default_str()
      ->group(kGrids);
  app.add_option("--fps", o->fps, "pictures per second of simulated time")
      ->needs(show)
      ->check(finiteRange(0.1, 1000.0))
      ->capture_default_str()
      ->group(kGrids);
  app.add_option("--codec", o->codec, "encoding of frames on the network: see strandcastd --help")
      ->check(CLI::IsMember({"float32", "delta16", "oct12", "oct16", "tangent", "temporal"}))
      ->excludes(check)
      ->excludes(resimulate)
      ->excludes(show)
      ->capture_default_str();
  app.add_flag("--json", o->json, "print the closing summary as one JSON object");
  addNetworkOptions(app, o->settings);
  return [o, &app] {
    checkNetworkOptions(app, o->settings);
    return replay(*o);
  };
}

}  // namespace strandcast
