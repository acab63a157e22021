#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "apps/cli/verbs.h"
#include "core/error.h"
#include "gl/context.h"
#include "options/console.h"
#include "options/number_range.h"
#include "options/output_folder.h"
#include "options/picture_options.h"
#include "options/picture_scene.h"
#include "options/scene_loading.h"
#include "options/traced_picture.h"
#include "service/scene_simulation.h"
#include "service/slices.h"
#include "service/stream.h"

namespace strandcast {
namespace {

struct RenderOptions {
  std::unique_ptr<SettingsOptions> settings;
  PictureOptions picture;
  TraceOptions trace;
  std::filesystem::path out = "out";
  std::filesystem::path movie;
  std::string show = "hair", slice = "z";
  int frames = 60;
  double fps = 30;
  double skip = 0;      // s
  double timeout = 20;  // s
  bool json = false;
  CLI::Option *movie_option = nullptr, *frames_option = nullptr;
  bool films() const { return movie_option->count() > 0; }
};

/// `status`: the newest one received; the daemon may have ended since.
void report(const RenderOptions& o, Subscriber& subscriber, const std::optional<Status>& status,
            const FrameCapture& capture, int samples, int drawn, double draw_ms) {
  const ReceiveStatistics r = subscriber.statistics();
  Report out;
  if (const Status* s = status ? &*status : nullptr) {
    out.add("groom", "groom", s->groom_name);
    out.add("backend", "backend", s->backend);
    out.add("device", "device", s->device);
    out.addCount("strands", "strands", s->strands);
    out.addCount("vertices", "vertices", s->vertices);
    out.add("step_ms_median", "step, median", s->step_ms_median, "ms", 3);
    out.add("step_ms_p95", "step, 95th percentile", s->step_ms_p95, "ms", 3);
    const auto newest = subscriber.frame();  // newer than the status
    out.addCount("frames_published", "frames published", std::max(s->frames, newest ? newest->frame : 0));
    out.add("mean_stretch", "mean stretch", s->mean_stretch, "", 6);
    out.add("max_stretch", "max stretch", s->max_stretch, "", 6);
    out.add("max_penetration_m", "max penetration", s->max_penetration, "m", 6);
  }
  out.addCount("frames_received", "frames received", r.frames_received);
  out.addCount("frames_lost", "frames lost", r.frames_lost);
  if (r.frames_concealed > 0) out.addCount("frames_concealed", "with concealed strands", r.frames_concealed);
  if (r.payload_bytes > 0) {
    if (status) out.add("codec", "codec", status->encoding.codec);
    out.addCount("bytes_per_frame", "bytes per frame, mean", r.payload_bytes / r.frames_received);
  }
  out.add("latency_ms_p50", "latency, median", r.latency_ms_p50, "ms", 3);
  out.add("latency_ms_p99", "latency, 99th percentile", r.latency_ms_p99, "ms", 3);
  if (capture.skippedFrames() > 0)
    out.addCount("frames_passed_over", "frames skipped", static_cast<uint64_t>(capture.skippedFrames()));
  out.addCount("frames_drawn", "frames drawn", static_cast<uint64_t>(drawn));
  out.addCount("samples", "samples per pixel", static_cast<uint64_t>(samples));
  out.add("draw_ms", "drawing, mean", drawn > 0 ? draw_ms / drawn : 0, "ms per frame", 1);
  out.add("out", "pictures", (o.out / "frame_*.png").string());
  out.print(o.json);
}

/// Steps the scene in this process and draws slices through its grids, which are not transmitted.
int renderAir(const RenderOptions& o, const Settings& settings) {
  if (!o.settings->namesScene())
    throw Error("a daemon does not publish its grids", "--show " + o.show,
                "name what to simulate, e.g. --scene straight");
  if (o.films()) checkMovie(o.movie);
  const Scene scene = makeSceneWithProgress(settings.scene);
  Simulation simulation = makeSimulation(scene, settings);
  AirFilm film(o.show, o.slice, std::min(o.picture.settings.width, o.picture.settings.height), o.out);
  ProgressBar bar;
  const auto time_step = static_cast<double>(simulation.parameters().time_step);
  if (o.fps * time_step > 1 + 1e-6)
    spdlog::warn("the scene has {:g} steps per second, fewer than pictures: pictures are repeated",
                 1 / time_step);
  const auto step = [&] {
    const double end = simulation.time() + time_step;
    moveTo(scene.skinned.get(), end, scene.motion(end), simulation);
    simulation.step();
    simulation.resetDiverged();
  };
  step();  // grids exist only after the first step
  const double start = std::max(simulation.time(), o.skip);
  while (film.drawn() < o.frames && !g_interrupted) {
    while (simulation.time() < start + film.drawn() / o.fps - 0.5e-3 * time_step && !g_interrupted) step();
    film.draw(simulation);
    bar.show(fmt::format("slice {} of {}", film.drawn(), o.frames),
             static_cast<double>(film.drawn()) / o.frames);
  }
  if (o.films() && film.drawn() > 0) makeMovie(o.out, film.drawn(), o.fps, o.movie);
  Report out;
  film.addTo(out);
  out.print(o.json);
  return g_interrupted ? kExitInterrupted : 0;
}

/// Of path traced pictures: totals, and the noise of the worst.
void reportTraced(const RenderOptions& o, const std::vector<TracedPicture>& traced) {
  TracedPicture all;
  int there = 0;
  for (const TracedPicture& one : traced) {
    all.samples += one.samples;
    all.seconds += one.seconds;
    all.error = std::max(all.error, one.error);
    all.hairs = std::max(all.hairs, one.hairs);
    all.segments = std::max(all.segments, one.segments);
    there += one.was_there;
  }
  const double made = static_cast<double>(traced.size()) - there;
  const double pixels = made * o.picture.settings.width * o.picture.settings.height;
  Report out;
  out.addCount("hairs", "hairs", all.hairs);
  out.addCount("segments", "segments of hair", all.segments);
  out.addCount("frames_traced", "frames traced", static_cast<uint64_t>(made));
  if (there > 0) out.addCount("frames_there", "frames that were there", static_cast<uint64_t>(there));
  if (made > 0) {
    out.add("samples_per_pixel", "samples per pixel, mean", static_cast<double>(all.samples) / pixels, "", 1);
    out.add("relative_error", "standard error over the mean", all.error, "", 5);
    out.add("trace_s", "tracing", all.seconds, "s", 2);
  }
  out.add("out", "pictures", (o.out / "frame_*.exr, *.png").string());
  out.print(o.json);
}

/// A captured frame with the colliders of its time.
struct Shot {
  CapturedFrame captured;
  std::shared_ptr<const ColliderSet> colliders;
};

/// Captures all frames, ends the stream, so that a scene in this process takes no more time, and traces them.
int renderTraced(const RenderOptions& o, const Settings& settings) {
  if (o.show != "hair")
    throw Error("slices through grids are not path traced", "--show " + o.show, "leave out --method");
  if (o.films()) checkMovie(o.movie);
  const Sky sky = skyOf(o.trace);
  RenderSettings render_settings = renderSettings(o.picture);
  render_settings.growth_path = GrowthPath::kCompute;
  PictureFolder pictures(o.out, o.trace.resume);
  const int frames = o.frames_option->count() > 0 ? o.frames : 1;
  std::vector<Shot> shots;
  {
    Stream stream(settings, o.settings->namesScene(), o.timeout);
    FrameCapture capture(stream, {frames, o.fps, o.skip, o.timeout});
    while (std::optional<CapturedFrame> captured = capture.next())
      shots.push_back({*std::move(captured), stream.subscriber().colliders()});
  }
  gl::HeadlessContext context;
  context.makeCurrent();
  Renderer renderer(render_settings);
  StreamScene scene;
  Box box;
  std::vector<TracedPicture> traced;
  for (size_t i = 0; i < shots.size() && !g_interrupted; ++i) {
    const Shot& shot = shots[i];
    const bool is_new = shot.captured.scene != scene;
    if (is_new) {
      scene = shot.captured.scene;
      setScene(renderer, *scene.groom, *scene.body, scene.hairs.get());
      box = pictureBox(*scene.groom, *scene.body, renderer.hairReach());
    }
    if (is_new || shot.colliders != shots[i - 1].colliders)
      setObstacles(renderer, o.picture, shot.colliders.get(), *scene.body);
    std::filesystem::path file = picturePath(o.out, pictures.written());
    file.replace_extension(".exr");
    traced.push_back(tracePicture(pathScene(renderer.geometry(*shot.captured.frame), renderer.settings(),
                                            pictureCamera(o.picture, box), o.trace, sky),
                                  o.trace, exposureGains(renderer.settings()), file,
                                  fmt::format("frame {} of {}", i + 1, frames)));
    if (traced.back().was_there)
      pictures.skip();
    else
      pictures.write(std::exchange(traced.back().image, {}));
  }
  if (o.films() && pictures.written() > 0) makeMovie(o.out, pictures.written(), o.fps, o.movie);
  if (!traced.empty()) reportTraced(o, traced);
  if (g_interrupted) return kExitInterrupted;
  if (static_cast<int>(traced.size()) < frames) {
    spdlog::warn("the stream ended after {} of {} frames", traced.size(), frames);
    return kExitCheckFailed;
  }
  return 0;
}

int render(const RenderOptions& o) {
  o.settings->refuseWithoutScene();
  o.settings->warnOfUnusedNetwork();
  warnOfUnusedPictureOptions(o.picture);
  checkTraceOptions(o.trace, o.picture);
  const Settings settings = o.settings->resolve();
  if (o.trace.is_on) return renderTraced(o, settings);
  if (o.show != "hair") return renderAir(o, settings);
  if (o.films()) checkMovie(o.movie);
  PictureFolder pictures(o.out);
  gl::HeadlessContext context;
  Stream stream(settings, o.settings->namesScene(), o.timeout);
  Subscriber& subscriber = stream.subscriber();
  context.makeCurrent();

  FrameCapture capture(stream, {o.frames, o.fps, o.skip, o.timeout});
  Renderer renderer(renderSettings(o.picture));
  const int samples = renderer.statistics().samples;
  if (samples != renderer.settings().samples)
    spdlog::warn("the OpenGL device has {} samples per pixel, not the {} of --samples", samples,
                 renderer.settings().samples);
  StreamScene scene;
  std::shared_ptr<const ColliderSet> colliders;
  Box box;
  std::optional<Status> status;
  int drawn = 0;
  double draw_ms = 0;
  {
    ProgressBar bar;
    while (const std::optional<CapturedFrame> captured = capture.next()) {
      const bool is_new = captured->scene != scene;
      if (is_new) {
        scene = captured->scene;
        setScene(renderer, *scene.groom, *scene.body, scene.hairs.get());
        box = pictureBox(*scene.groom, *scene.body, renderer.hairReach());
      }
      if (is_new || subscriber.colliders() != colliders) {
        colliders = subscriber.colliders();
        setObstacles(renderer, o.picture, colliders.get(), *scene.body);
      }
      if (const auto now = subscriber.status()) status = now;
      const auto start = std::chrono::steady_clock::now();
      const Camera camera = pictureCamera(o.picture, box);
      renderer.draw(*captured->frame, camera);
      const Image image = renderer.read();
      draw_ms += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
      pictures.write(image);
      subscriber.setPictures(pixelsOfHair(camera, *captured->frame, image.height), static_cast<float>(o.fps));
      ++drawn;
      bar.show(fmt::format("frame {} of {}", drawn, o.frames), static_cast<double>(drawn) / o.frames);
    }
  }
  if (o.films() && drawn > 0) makeMovie(o.out, drawn, o.fps, o.movie);
  if (const auto now = subscriber.status()) status = now;
  report(o, subscriber, status, capture, samples, drawn, draw_ms);
  if (g_interrupted) return kExitInterrupted;
  if (drawn < o.frames) {
    spdlog::warn("{} after {} of {} frames",
                 capture.isPaused() ? "the daemon was paused" : "the stream ended", drawn, o.frames);
    return kExitCheckFailed;
  }
  return 0;
}

}  // namespace

Verb addRender(CLI::App& app) {
  const auto o = std::make_shared<RenderOptions>();
  app.footer(
      "With --scene, --groom or --config the simulation runs inside this process; without them, the verb "
      "draws a daemon's stream.\n"
      "Examples:\n"
      "  strandcast render --frames 60 --out out\n"
      "  strandcast render --scene curly --frames 90 --out out --movie curly.mp4\n"
      "  strandcast render --scene curly --method path_tracer --spp 64 --width 512 --height 512\n"
      "  strandcast render --scene straight --set wind=3,0,0 --set wind_grid=1 --show wind");
  app.add_option("--out", o->out, "folder for frame_0000.png and following")->capture_default_str();
  o->frames_option =
      app.add_option("--frames", o->frames, "number of pictures to draw; by default one of the path tracer")
          ->transform(wholeRange(1, 1000000))
          ->capture_default_str();
  app.add_option("--fps", o->fps,
                 "pictures per second of simulated time; a picture between two frames of the stream "
                 "interpolates them")
      ->check(finiteRange(0.1, 1000.0))
      ->capture_default_str();
  app.add_option("--skip", o->skip, "seconds of simulated time before the first picture")
      ->check(finiteRange(0.0, 1e6));
  auto* show =
      app.add_option("--show", o->show,
                     "hair, or a slice through the grids of a scene: density, wind, pressure or divergence; "
                     "the slice is a square with the shorter of --width and --height as its side")
          ->check(CLI::IsMember({"hair", "density", "wind", "pressure", "divergence"}))
          ->capture_default_str();
  app.add_option("--slice", o->slice, "axis perpendicular to the slice")
      ->check(CLI::IsMember({"x", "y", "z"}))
      ->needs(show)
      ->capture_default_str();
  o->movie_option = app.add_option("--movie", o->movie, "also encode the pictures as this film, with ffmpeg");
  app.add_option(
         "--timeout", o->timeout,
         "seconds to wait for a daemon and for its next frame; a paused daemon gives only its current frame")
      ->check(finiteRange(0.1, 3600.0))
      ->capture_default_str();
  app.add_flag("--json", o->json, "print the closing summary as one JSON object");
  addPictureOptions(app, o->picture);
  addTraceOptions(app, o->trace);
  o->settings = std::make_unique<SettingsOptions>(app);
  return [o] { return render(*o); };
}

}  // namespace strandcast
