#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/cli/verbs.h"
#include "core/error.h"
#include "groom/groom_check.h"
#include "io/file_bytes.h"
#include "options/console.h"
#include "options/scene_loading.h"
#include "options/settings.h"
#include "scenes/scene_check.h"
#include "service/show_cost.h"
#ifdef STRANDCAST_HAS_RENDER
#include "gl/context.h"
#include "options/picture_scene.h"
#endif

namespace strandcast {
namespace {

struct CheckOptions {
  std::unique_ptr<SettingsOptions> settings;
  std::vector<std::string> files;
  std::filesystem::path picture;
  bool no_cost = false, json = false;
};

/// GROOM... with --body, else GROOM [BODY [CLIP]].
void nameCheckedFiles(const CLI::App& app, CheckOptions& o) {
  const std::vector<std::string>& files = o.files;
  if (files.size() < 2 || app.count("--body") > 0) return o.settings->nameFiles(files, "", "");
  const auto isOneOf = [](const std::string& file, std::initializer_list<const char*> extensions) {
    return std::find(extensions.begin(), extensions.end(), lowerExtension(file)) != extensions.end();
  };
  const std::string clip = files.size() > 2 ? files[2] : "";
  if (files.size() > 3 || !isOneOf(files[1], {".obj", ".gltf", ".glb"}) ||
      isOneOf(clip, {".tfx", ".hair", ".usda", ".obj", ".gltf", ".glb"}))
    throw Error("arguments are a groom, a body mesh and a clip", files.size() > 3 ? files[3] : files[1],
                "with several groom files, name the body: --body FILE [--clip CLIP]");
  o.settings->nameFiles({files[0]}, files[1], clip);
}

/// A wrong size or place makes every further number void, and a bake a waste of time.
bool isMisplaced(const CheckReport& report) {
  for (const char* key : {"groom_size", "hair_length", "body_size", "scale", "placement"})
    if (const CheckResult* found = report.find(key); found && found->severity == CheckSeverity::kFault)
      return true;
  return false;
}

/// Makes the scene as a daemon does and runs it. Adds the warnings of the bake. Without a value where it
/// cannot be simulated.
std::optional<ShowCost> runChecked(const Settings& settings, CheckReport& report) {
  try {
    const Scene scene = makeSceneWithProgress(settings.scene);
    for (const std::string& warning : scene.warnings) {
      const auto is_it = [&](const CheckResult& row) { return row.what == warning; };
      const bool is_of_surface = warning.starts_with("the body: ");  // rows body_* have it
      if (!is_of_surface && std::none_of(report.results.begin(), report.results.end(), is_it))
        report.add({CheckSeverity::kWarning, "scene", warning, 1});
    }
    ProgressBar bar;
    const ShowCost cost =
        measureShowCost(scene, settings, [&](double part) { bar.show("a short run", part); });
    report.add(checkCost(cost, settings.rate));
    return cost;
  } catch (const Error& error) {
    report.add({CheckSeverity::kFault, "run", fmt::format("it cannot be simulated: {}", error.what()), 1});
    return std::nullopt;
  }
}

#ifdef STRANDCAST_HAS_RENDER
constexpr int kViewSide = 900;  // pixels

/// Paints marks over a picture, also those behind a surface: what is inside the body would not be seen.
void paintMarks(Image& image, const Camera& camera, const std::vector<CheckMark>& marks) {
  using Colour = std::array<uint8_t, 3>;
  const std::pair<CheckMark::Kind, Colour> colours[] = {{CheckMark::Kind::kInside, {230, 0, 200}},
                                                        {CheckMark::Kind::kRoot, {255, 30, 20}},
                                                        {CheckMark::Kind::kShape, {255, 220, 0}}};
  constexpr int kReach = 2;  // pixels to each side
  const float aspect = static_cast<float>(image.width) / static_cast<float>(image.height);
  for (const auto& [kind, colour] : colours)
    for (const CheckMark& mark : marks) {
      if (mark.kind != kind || !mark.position.allFinite()) continue;
      const std::optional<PicturePoint> at = projected(camera, mark.position, aspect);
      if (!at || std::min(at->x, at->y) < 0 || std::max(at->x, at->y) > 1) continue;
      const int x = static_cast<int>(at->x * static_cast<float>(image.width));
      const int y = static_cast<int>(at->y * static_cast<float>(image.height));
      for (int row = std::max(y - kReach, 0); row <= std::min(y + kReach, image.height - 1); ++row)
        for (int column = std::max(x - kReach, 0); column <= std::min(x + kReach, image.width - 1); ++column)
          std::copy(colour.begin(), colour.end(),
                    image.rgb.begin() + 3 * (static_cast<ptrdiff_t>(row) * image.width + column));
    }
}

/// Front and back of the groom on its body at rest, side by side, with marks.
Image checkPicture(const Scene& scene, const CheckReport& report) {
  GroomDescription groom;
  groom.name = scene.name;
  groom.hair_radius = scene.parameters.hair_radius;
  groom.guides = scene.groom.strands;
  BodyDescription body;
  body.mesh = scene.body;
  GuideFrame frame;
  frame.frame = 1;
  frame.positions = groom.guides.positions;
  PictureOptions options;
  options.settings.width = options.settings.height = kViewSide;
  gl::HeadlessContext context;
  Renderer renderer(renderSettings(options));
  setScene(renderer, groom, body);
  Box box = pictureBox(groom, body, renderer.hairReach());
  if (isMisplaced(report) && !body.mesh.empty()) box = box.merged(body.mesh.bounds());
  Image joined;
  joined.width = 2 * kViewSide;
  joined.height = kViewSide;
  joined.rgb.resize(3 * static_cast<size_t>(joined.width) * static_cast<size_t>(joined.height));
  const double front = options.azimuth;
  for (int view = 0; view < 2; ++view) {
    options.azimuth = front + 180 * view;
    const Camera camera = pictureCamera(options, box);
    renderer.draw(frame, camera);
    Image image = renderer.read();
    paintMarks(image, camera, report.marks);
    constexpr ptrdiff_t kRow = 3 * kViewSide;  // bytes
    for (ptrdiff_t row = 0; row < kViewSide; ++row)
      std::copy_n(image.rgb.begin() + row * kRow, kRow, joined.rgb.begin() + (2 * row + view) * kRow);
  }
  return joined;
}
#endif

/// Draws the picture. Empty on success, else why there is none.
std::string drawChecked([[maybe_unused]] const CheckOptions& o, [[maybe_unused]] const Scene& scene,
                        [[maybe_unused]] const CheckReport& report) {
#ifdef STRANDCAST_HAS_RENDER
  try {
    writePng(o.picture, checkPicture(scene, report));
    return {};
  } catch (const Error& error) {
    return error.what();
  }
#else
  return "this program is built without OpenGL";
#endif
}

/// What was asked for and what came of it.
struct Checked {
  CheckReport report;
  std::optional<ShowCost> cost;
  std::string no_picture;  ///< why there is none; empty where one was drawn or none was asked for
};

void printChecked(const CheckOptions& o, const Checked& checked) {
  for (const CheckResult& result : checked.report.results) {
    fmt::print("  {:<8} {}\n", nameOf(result.severity), result.what);
    if (!result.where.empty() && result.severity != CheckSeverity::kOk)
      fmt::print("  {:<8}   where: {}\n", "", result.where);
    if (!result.remedy.empty()) fmt::print("  {:<8}   remedy: {}\n", "", result.remedy);
  }
  if (!o.picture.empty() && checked.no_picture.empty())
    fmt::print("picture: {}; roots off the skin are red, vertices inside the body magenta, folds yellow\n",
               o.picture.string());
  fmt::print("verdict: {} (faults: {}, warnings: {})\n", verdictOf(checked.report.worst()),
             checked.report.count(CheckSeverity::kFault), checked.report.count(CheckSeverity::kWarning));
}

void printCheckedJson(const CheckOptions& o, const Settings& settings, const Checked& checked) {
  nlohmann::json results = nlohmann::json::array(), grooms = nlohmann::json::array(), cost;
  for (const CheckResult& result : checked.report.results)
    results.push_back({{"check", result.key},
                       {"severity", nameOf(result.severity)},
                       {"what", result.what},
                       {"number", result.number},
                       {"unit", result.unit},
                       {"where", result.where},
                       {"remedy", result.remedy}});
  for (const std::filesystem::path& file : settings.scene.groom) grooms.push_back(file.string());
  if (const ShowCost* c = checked.cost ? &*checked.cost : nullptr)
    cost = {{"backend", c->backend},
            {"device", c->device},
            {"strands", c->strands},
            {"vertices", c->vertices},
            {"steps", c->steps},
            {"steps_per_frame", c->steps_per_frame},
            {"step_ms_median", c->step_ms_median},
            {"step_ms_p95", c->step_ms_p95},
            {"encode_ms_median", c->encode_ms_median},
            {"codec", c->codec},
            {"bytes_per_frame", c->bytes_per_frame},
            {"memory_bytes", c->memory_bytes},
            {"rate", settings.rate}};
  const bool drawn = !o.picture.empty() && checked.no_picture.empty();
  fmt::print("{}\n", jsonText({{"verdict", verdictOf(checked.report.worst())},
                               {"faults", checked.report.count(CheckSeverity::kFault)},
                               {"warnings", checked.report.count(CheckSeverity::kWarning)},
                               {"groom", grooms},
                               {"body", settings.scene.body.string()},
                               {"clip", settings.scene.skinned ? settings.scene.skinned->clip : ""},
                               {"results", results},
                               {"cost", cost},
                               {"picture", drawn ? nlohmann::json(o.picture.string()) : nlohmann::json()}}));
}

int checkShow(const CheckOptions& o) {
  if (!o.picture.empty()) {
    if (lowerExtension(o.picture) != ".png")
      throw Error("pictures are .png files", "--picture " + o.picture.string(), "e.g. --picture check.png");
    checkWritable(o.picture);
  }
  const Settings settings = o.settings->resolve();
  Checked checked;
  CheckedScene scene;
  {
    ProgressBar bar;
    const Progress progress = [&](const std::string& what, double part) {
      bar.show(what, part);
      return !g_interrupted.load();
    };
    scene = loadForCheck(settings.scene, progress);
    checked.report = checkScene(scene, settings.scene, settings.rate, progress);
  }
  if (!o.no_cost && isMisplaced(checked.report))
    checked.report.add({CheckSeverity::kOk, "run", "not run: sizes and places are to be corrected first", 0});
  else if (!o.no_cost)
    checked.cost = runChecked(settings, checked.report);
  if (!o.picture.empty()) checked.no_picture = drawChecked(o, scene.scene, checked.report);
  if (!checked.no_picture.empty()) spdlog::warn("no picture is drawn: {}", checked.no_picture);
  if (o.json)
    printCheckedJson(o, settings, checked);
  else
    printChecked(o, checked);
  return checked.report.worst() == CheckSeverity::kFault ? kExitCheckFailed : 0;
}

}  // namespace

Verb addCheck(CLI::App& app) {
  const auto o = std::make_shared<CheckOptions>();
  app.footer(
      "Run it before a show. It reads groom, body and clip as a daemon would, checks them, runs a second of "
      "the\n"
      "simulation, and ends with a verdict: ready, ready with warnings (exit status 0) or not ready (1).\n"
      "Checked are sizes and axes, roots on the skin, hair inside the body, faulty strands, what was left "
      "out, "
      "the\n"
      "body's surface, the skin under the roots over the clip, and time, memory and bytes of a frame. Each "
      "row "
      "has\n"
      "its number, the worst place and a remedy. A wrong unit or axis is answered with the options that "
      "fit.\n"
      "Examples:\n"
      "  strandcast check bob.tfx head.obj --unit-meters 0.01 --picture check.png\n"
      "  strandcast check hero.tfx hero.glb walk.bvh --rate 60 --codec temporal\n"
      "  strandcast check tail.tfx side.tfx back.tfx --body head.obj --json");
  app.add_option(
      "GROOM", o->files,
      "groom files (.tfx, .hair, .obj, .usda). Without --body: GROOM BODY [CLIP], one groom file, the "
      "body mesh and a clip");
  app.add_option("--picture", o->picture,
                 "PNG file to draw: front and back, with faulty roots and vertices marked by colour")
      ->check([](const std::string& file) { return file.empty() ? "name a file" : std::string(); }, "");
  app.add_flag("--no-cost", o->no_cost, "neither bake the body nor run the simulation");
  app.add_flag("--json", o->json, "print one JSON object");
  o->settings = std::make_unique<SettingsOptions>(app, SettingsUse::kCheck);
  return [o, &app] {
    nameCheckedFiles(app, *o);
    return checkShow(*o);
  };
}

}  // namespace strandcast
