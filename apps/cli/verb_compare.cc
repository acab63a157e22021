#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <deque>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "apps/cli/verbs.h"
#include "gl/context.h"
#include "options/console.h"
#include "options/number_range.h"
#include "options/output_folder.h"
#include "options/picture_options.h"
#include "options/picture_scene.h"
#include "options/scene_loading.h"
#include "service/colliders.h"
#include "service/shake_trial.h"

namespace strandcast {
namespace {

struct CompareOptions {
  std::unique_ptr<SettingsOptions> settings;
  PictureOptions picture;
  std::vector<std::string> solvers{"rod", "gauss_seidel"};
  double shake = 3, rest = 3;  // s
  std::filesystem::path out = "film", movie;
  size_t frames = 60;
  bool no_pictures = false, json = false;
  CLI::Option* movie_option = nullptr;
};

/// Draws the scene under every solver with one camera into one picture, side by side.
class SideBySide {
 public:
  /// `simulation`: any of the trials'.
  SideBySide(const CompareOptions& options, PictureFolder& folder, const Scene& scene,
             const Simulation& simulation)
      : folder_(folder), renderer_(renderSettings(options.picture)) {
    GroomDescription groom;
    groom.name = scene.name;
    groom.hair_radius = simulation.parameters().hair_radius;
    groom.guides = scene.groom.strands;
    BodyDescription body;
    body.mesh = scene.body;
    body.head_weights = scene.head_weights;
    setScene(renderer_, groom, body);
    ColliderSet colliders;
    colliders.colliders = collidersOf(simulation);
    setObstacles(renderer_, options.picture, &colliders, body);
    camera_ = pictureCamera(options.picture, pictureBox(groom, body, renderer_.hairReach()));
  }

  void draw(std::deque<ShakeTrial>& trials) {
    Image joined;
    std::vector<Image> parts;
    for (ShakeTrial& trial : trials) {
      trial.fill(frame_);
      renderer_.draw(frame_, camera_);
      parts.push_back(renderer_.read());
      joined.width += parts.back().width;
      joined.height = parts.back().height;
    }
    for (int y = 0; y < joined.height; ++y)
      for (const Image& part : parts) {
        const auto row = part.rgb.begin() + static_cast<ptrdiff_t>(y) * part.width * 3;
        joined.rgb.insert(joined.rgb.end(), row, row + static_cast<ptrdiff_t>(part.width) * 3);
      }
    folder_.write(joined);
  }

 private:
  PictureFolder& folder_;
  gl::HeadlessContext context_;
  Renderer renderer_;
  Camera camera_;
  GuideFrame frame_;
};

struct Quantity {
  const char *key, *label, *unit;
  double scale;  // factor from SI to `unit`
  double ShakeResult::*value;
};
constexpr Quantity kMeasured[] = {
    {"step_ms_median", "step, median", "ms", 1, &ShakeResult::step_ms_median},
    {"mean_stretch_percent", "shaken: mean stretch", "%", 1e2, &ShakeResult::mean_stretch},
    {"max_stretch_percent", "shaken: largest stretch", "%", 1e2, &ShakeResult::max_stretch},
    {"style_rms_mm", "rested: style error, rms", "mm", 1e3, &ShakeResult::style_rms},
    {"style_max_mm", "rested: style error, largest", "mm", 1e3, &ShakeResult::style_max},
    {"rest_speed_mm_s", "rested: speed, rms", "mm/s", 1e3, &ShakeResult::rest_speed},
    {"max_penetration_mm", "largest penetration", "mm", 1e3, &ShakeResult::max_penetration}};
struct Count {
  const char *key, *label;
  uint64_t ShakeResult::*value;
};
constexpr Count kCounts[] = {
    {"strands_above_1_mm_s", "rested: strands above 1 mm/s", &ShakeResult::moving_strands},
    {"strands_reset", "strands reset", &ShakeResult::strands_reset}};

void printTable(const std::vector<std::string>& solvers, const std::vector<ShakeResult>& results) {
  auto row = [](const std::string& label, const std::string& unit, auto&& cell, size_t columns) {
    fmt::print("  {:<31} {:>5}", label, unit);
    for (size_t i = 0; i < columns; ++i) fmt::print(" {:>14}", cell(i));
    fmt::print("\n");
  };
  row(
      "", "", [&](size_t i) { return solvers[i]; }, solvers.size());
  for (const Quantity& q : kMeasured)
    row(
        q.label, q.unit, [&](size_t i) { return fmt::format("{:.4g}", q.scale * results[i].*q.value); },
        results.size());
  for (const Count& c : kCounts)
    row(
        c.label, "", [&](size_t i) { return fmt::format("{}", results[i].*c.value); }, results.size());
}

nlohmann::json toJson(const std::string& solver, const ShakeResult& result) {
  nlohmann::json object{{"solver", solver}};
  for (const Quantity& q : kMeasured) object[q.key] = q.scale * result.*q.value;
  for (const Count& c : kCounts) object[c.key] = result.*c.value;
  return object;
}

void report(const CompareOptions& o, const Scene& scene, std::deque<ShakeTrial>& trials) {
  std::vector<ShakeResult> results;
  for (ShakeTrial& trial : trials) results.push_back(trial.result());
  const StrandModel& model = trials.front().simulation().model();
  const Parameters& parameters = trials.front().simulation().parameters();
  const std::string backend = trials.front().simulation().backend().name();
  const std::string device = trials.front().simulation().backend().device();
  const std::string pictures = o.no_pictures ? "" : (o.out / "frame_*.png").string();
  if (!o.json) {
    fmt::print("{}: {} strands, {} vertices, shaken {:g} s, then at rest {:g} s, on {} ({})\n", scene.name,
               model.strands(), model.vertices(), o.shake, o.rest, backend, device);
    printTable(o.solvers, results);
    if (!pictures.empty()) fmt::print("pictures: {}, left to right as the columns\n", pictures);
    return;
  }
  nlohmann::json list = nlohmann::json::array();
  for (size_t i = 0; i < results.size(); ++i) list.push_back(toJson(o.solvers[i], results[i]));
  fmt::print("{}\n", jsonText({{"groom", scene.name},
                               {"strands", model.strands()},
                               {"vertices", model.vertices()},
                               {"shake_s", o.shake},
                               {"rest_s", o.rest},
                               {"backend", backend},
                               {"device", device},
                               {"time_step_s", parameters.time_step},
                               {"substeps", parameters.substeps},
                               {"iterations", parameters.iterations},
                               {"pictures", pictures},
                               {"solvers", list}}));
}

int compare(const CompareOptions& o) {
  Settings settings = o.settings->resolve();
  if (!o.no_pictures) warnOfUnusedPictureOptions(o.picture);
  if (settings.scene.motion.empty()) settings.scene.motion = "shake";
  if (o.movie_option->count() > 0) checkMovie(o.movie);
  std::optional<PictureFolder> folder;
  if (!o.no_pictures) folder.emplace(o.out);
  const Scene scene = makeSceneWithProgress(settings.scene);
  std::deque<ShakeTrial> trials;
  for (const std::string& solver : o.solvers) {
    settings.solver = solverKind(solver);
    trials.emplace_back(scene, settings, o.shake, o.rest);
  }
  std::optional<SideBySide> pictures;
  if (!o.no_pictures) pictures.emplace(o, *folder, scene, trials.front().simulation());
  const size_t steps = trials.front().steps(), frames = std::min(o.frames, steps);
  {
    ProgressBar bar;
    size_t drawn = 0;
    for (size_t step = 1; step <= steps && !g_interrupted; ++step) {
      for (ShakeTrial& trial : trials) trial.step();
      if (pictures && step * frames >= (drawn + 1) * steps) {
        pictures->draw(trials);
        ++drawn;
      }
      bar.show(fmt::format("step {} of {}", step, steps),
               static_cast<double>(step) / static_cast<double>(steps));
    }
  }
  if (g_interrupted) {
    spdlog::warn("interrupted before the end of the rest: nothing to report");
    return kExitInterrupted;
  }
  if (pictures && o.movie_option->count() > 0)
    makeMovie(o.out, static_cast<int>(frames), static_cast<double>(frames) / (o.shake + o.rest), o.movie);
  report(o, scene, trials);
  return 0;
}

}  // namespace

Verb addCompare(CLI::App& app) {
  const auto o = std::make_shared<CompareOptions>();
  app.footer(
      "Each solver has the same scene, steps and parameters. The head moves (--motion, by default shake),\n"
      "returns to its rest pose and stays there. Reported per solver: the time of a step; the stretch of "
      "edges\n"
      "while the head moves; the distance of vertices from the groomed shape at the end, and their speed\n"
      "in the last half second.\n"
      "Examples:\n"
      "  strandcast compare --scene curly --no-pictures\n"
      "  strandcast compare --groom bob.tfx --body head.obj --unit-meters 0.01 --width 640 --out film");
  app.add_option("--solvers", o->solvers, "separated by commas: rod, gauss_seidel")
      ->delimiter(',')
      ->check(CLI::IsMember({"rod", "gauss_seidel"}))
      ->capture_default_str();
  app.add_option("--shake", o->shake, "duration of the head's motion, s")
      ->check(finiteRange(0.1, 3600.0))
      ->capture_default_str();
  app.add_option("--rest", o->rest, "duration of the rest after the motion, s")
      ->check(finiteRange(0.1, 3600.0))
      ->capture_default_str();
  app.add_option("--out", o->out,
                 "folder for frame_0000.png and following; --width applies to each solver's part")
      ->capture_default_str();
  auto* frames = app.add_option("--frames", o->frames,
                                "number of pictures, evenly over the whole time; at most one per step")
                     ->transform(wholeRange(1, 1000000))
                     ->capture_default_str();
  auto* movie = o->movie_option =
      app.add_option("--movie", o->movie, "also encode the pictures as this real-time film, with ffmpeg");
  app.add_flag("--no-pictures", o->no_pictures, "print numbers only; needs no OpenGL")
      ->excludes(frames)
      ->excludes(movie);
  app.add_flag("--json", o->json, "print one JSON object");
  addPictureOptions(app, o->picture);
  o->settings = std::make_unique<SettingsOptions>(app, SettingsUse::kCompare);
  return [o] { return compare(*o); };
}

}  // namespace strandcast
