#include "options/traced_picture.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <utility>

#include "core/error.h"
#include "core/hash.h"
#include "io/exr.h"
#include "kernels/scalar_picture.h"
#include "options/console.h"
#include "options/number_range.h"

namespace strandcast {
namespace {

constexpr double kSkinIndex = 1.4, kSkinRoughness = 0.35;
constexpr int kGroundCorners = 96;
constexpr uint32_t kSamplesPerPass = 8;  // between looks at the clock for checkpoints
constexpr uint32_t kFirstGoal = 16;      // samples per pixel before the first estimate of noise
constexpr uint32_t kMostSamples = 1u << 24;
constexpr double kCheckpointSeconds = 60;
constexpr double kTau = 2 * std::numbers::pi;

/// Picture settings that change nothing about a traced picture.
const std::set<std::string> kUnusedWhenTraced = {
    "samples",       "coverage",        "supersampling",     "filter",        "detail",
    "finest-hair",   "longest-segment", "detail-hysteresis", "cull",          "geometry",
    "growth",        "importance-map",  "shading",           "shadow-layers", "layer-sizes",
    "beyond-layers", "shadow-depth",    "shadow-map",        "shadow-filter", "mark-guides",
    "mark-tangents", "mark-collided",   "mark-inside"};

}  // namespace

void addTraceOptions(CLI::App& app, TraceOptions& o) {
  CLI::Option_group* group = app.add_option_group(
      "Path tracer", "physically based light in hair, for stills and as a reference (docs/path-tracer.md)");
  group
      ->add_option_function<std::string>(
          "--method", [&o](const std::string& name) { o.is_on = name == "path_tracer"; },
          "renderer: OpenGL; path_tracer: also writes frame_0000.exr and following")
      ->check(CLI::IsMember({"renderer", "path_tracer"}))
      ->type_name("NAME")
      ->default_str("renderer");
  const auto add = [&o](CLI::Option* option) {
    o.options.push_back(option);
    return option;
  };
  CLI::Option* spp = add(group->add_option("--spp", o.spp, "samples per pixel"))
                         ->transform(wholeRange(1, 16777216))
                         ->capture_default_str();
  add(group->add_option("--noise", o.noise,
                        "sample until the standard error of pixels, over the mean radiance, is this"))
      ->check(finiteRange(1e-5, 10.0))
      ->excludes(spp);
  add(group->add_option("--path-seed", o.seed, "seed of the paths; another one gives other noise"))
      ->transform(wholeRange(0, 1000000000000000))
      ->capture_default_str();
  add(group->add_option("--max-bounces", o.max_bounces, "scatterings of a path; 0: no limit"))
      ->transform(wholeRange(0, 1000000))
      ->capture_default_str();
  CLI::Option* sky = add(group->add_option("--sky", o.sky,
                                           "equirectangular OpenEXR picture that lights the scene and is "
                                           "seen behind it: up in the top row, +z in the "
                                           "middle; by default the renderer's ambient light and background"))
                         ->type_name("FILE");
  add(group->add_option("--sky-color", o.sky_color,
                        "the same radiance from everywhere: red green blue, linear"))
      ->expected(3)
      ->check(finiteRange(0.0, 1e6))
      ->excludes(sky);
  add(group->add_option("--sky-intensity", o.sky_intensity, "factor of --sky or --sky-color"))
      ->check(finiteRange(0.0, 1e6))
      ->capture_default_str();
  add(group->add_option("--absorption", o.absorption,
                        "of red, green and blue per radius of a hair, for all hairs; by default such that "
                        "dense hair has its colour"))
      ->expected(3)
      ->check(finiteRange(0.0, 1000.0));
  add(group->add_option("--lens-radius", o.lens_radius, "[m] of a thin lens; 0: all is sharp"))
      ->check(finiteRange(0.0, 10.0))
      ->capture_default_str();
  add(group->add_option("--focus", o.focus, "[m] distance that is sharp; 0: the middle of hair and head"))
      ->check(finiteRange(0.0, 1e4))
      ->capture_default_str();
  add(group->add_flag("--resume", o.resume, "continue interrupted pictures of the same scene and options"));
}

void checkTraceOptions(const TraceOptions& options, const PictureOptions& picture) {
  if (!options.is_on) {
    for (const CLI::Option* option : options.options)
      if (option->count() > 0)
        throw Error(option->get_name() + " is for path tracing", "options", "add --method path_tracer");
    return;
  }
  for (const auto& [name, light] : picture.given)
    if (kUnusedWhenTraced.contains(name)) spdlog::warn("--{} is not used: --method is path_tracer", name);
}

Sky skyOf(const TraceOptions& options) {
  if (!options.sky.empty()) return Sky::readPicture(options.sky, options.sky_intensity);
  if (options.sky_color.empty()) return Sky::ambient();
  const std::vector<double>& c = options.sky_color;
  return Sky::constant(options.sky_intensity * Eigen::Array3d(c.at(0), c.at(1), c.at(2)));
}

namespace {

TracedMesh groundMesh(const PictureGeometry& geometry, uint32_t material) {
  TracedMesh ground;
  ground.material = material;
  ground.mesh.positions.push_back(geometry.ground_center);
  for (int i = 0; i < kGroundCorners; ++i) {
    const double angle = kTau * i / kGroundCorners;
    ground.mesh.positions.push_back(geometry.ground_center +
                                    geometry.ground_radius * Vec3(static_cast<float>(std::cos(angle)), 0,
                                                                  static_cast<float>(std::sin(angle))));
    const auto own = static_cast<uint32_t>(i + 1);
    ground.mesh.triangles.push_back({0, static_cast<uint32_t>((i + 1) % kGroundCorners + 1), own});
  }
  return ground;
}

/// Radiance that tone mapping shows as the renderer's background.
std::vector<Eigen::Array3f> backdropOf(const RenderSettings& settings) {
  const Vec3 gains = exposureGains(settings);
  std::vector<Eigen::Array3f> radiance;
  radiance.reserve(static_cast<size_t>(settings.width) * static_cast<size_t>(settings.height));
  const auto width = static_cast<float>(settings.width), height = static_cast<float>(settings.height);
  for (int row = 0; row < settings.height; ++row)
    for (int column = 0; column < settings.width; ++column) {
      const float x = (static_cast<float>(column) + 0.5f - 0.5f * width) / height;
      const float y = (0.5f * height - static_cast<float>(row) - 0.5f) / height;
      const Vec3& b = settings.background;
      const kernels::f32::real3 color = kernels::f32::backdropColor({b.x(), b.y(), b.z()}, x, y);
      const Vec3 shown(color.x, color.y, color.z);
      Eigen::Array3f value;
      for (int c = 0; c < 3; ++c) value[c] = -std::log1p(-std::clamp(shown[c], 0.0f, 0.999f)) / gains[c];
      radiance.push_back(value);
    }
  return radiance;
}

Vec3 absorptionOf(const Vec3& color, const FibreMaterial& fibre) {
  const Eigen::Array3d reflectance = color.cast<double>().array().max(0.0).min(1.0);
  return absorptionOfReflectance(reflectance, fibre.azimuthal_roughness).cast<float>().matrix();
}

Eigen::Array3d albedoOf(const Vec3& color) { return color.cast<double>().array(); }

}  // namespace

PathScene pathScene(PictureGeometry geometry, const RenderSettings& settings, const Camera& camera,
                    const TraceOptions& options, const Sky& sky) {
  PathScene scene;
  if (!options.absorption.empty())
    for (int c = 0; c < 3; ++c) scene.fibre.sigma_a[c] = options.absorption[static_cast<size_t>(c)];
  const Vec3 common = scene.fibre.sigma_a.cast<float>().matrix();
  scene.hair.absorption.reserve(geometry.hairs());
  for (const std::array<Vec3, 2>& ends : geometry.colors)
    scene.hair.absorption.push_back(
        options.absorption.empty()
            ? std::array{absorptionOf(ends[0], scene.fibre), absorptionOf(ends[1], scene.fibre)}
            : std::array{common, common});
  scene.hair.radii = std::move(geometry.widths);
  for (float& radius : scene.hair.radii) radius /= 2;
  scene.hair.offsets = std::move(geometry.offsets);
  scene.hair.positions = std::move(geometry.positions);
  scene.hair.tangents = std::move(geometry.tangents);

  scene.materials.push_back({CoatedDiffuse(albedoOf(settings.body_color), kSkinIndex, kSkinRoughness)});
  if (camera.eye.y() > geometry.ground_center.y()) {  // seen from below there is none
    scene.meshes.push_back(groundMesh(geometry, 1));
    const Vec3 albedo = kernels::f32::groundAlbedo() * settings.background;
    scene.materials.push_back(
        {CoatedDiffuse(albedoOf(albedo), 1, 0.5), geometry.ground_center, geometry.ground_radius});
  }
  scene.meshes.push_back({std::move(geometry.body), 0});

  scene.lights = settings.lights;
  scene.shadows = settings.shadows;
  scene.sky = sky;
  if (options.sky.empty() && options.sky_color.empty()) scene.backdrop = backdropOf(settings);
  scene.camera.view = viewMatrix(camera);
  scene.camera.vertical_fov = camera.vertical_fov;
  scene.camera.lens_radius = static_cast<float>(options.lens_radius);
  scene.camera.focus =
      options.focus > 0 ? static_cast<float>(options.focus) : (camera.target - camera.eye).norm();
  scene.width = settings.width;
  scene.height = settings.height;
  scene.seed = options.seed;
  scene.max_bounces = options.max_bounces;
  return scene;
}

namespace {

template <class T>
void addAll(ContentHash& hash, const std::vector<T>& values) {
  hash.add(values.data(), values.size() * sizeof(T));
}

/// Identifies all that a picture's pixels depend on, but for the number of samples.
uint64_t contentOf(const PathScene& scene, const TraceOptions& options) {
  ContentHash hash;
  addAll(hash, scene.hair.offsets);
  addAll(hash, scene.hair.positions);
  addAll(hash, scene.hair.tangents);
  addAll(hash, scene.hair.radii);
  addAll(hash, scene.hair.absorption);
  for (const TracedMesh& mesh : scene.meshes) {
    addAll(hash, mesh.mesh.positions);
    addAll(hash, mesh.mesh.triangles);
  }
  addAll(hash, scene.backdrop);
  for (const SurfaceMaterial& material : scene.materials)
    for (const double z : {0.2, 0.9}) {
      const Eigen::Vector3d w(std::sqrt(1 - z * z), 0, z);
      for (const double value : material.scattering.f(w, Eigen::Vector3d::UnitZ())) hash.add(value);
    }
  for (const Light& light : scene.lights) {
    for (const Vec3& v : {light.direction, light.position, light.color})
      hash.add(v.data(), 3 * sizeof(float));
    for (const float v : {light.intensity, light.cone, light.cone_edge, light.width, light.height})
      hash.add(v);
    hash.add(static_cast<int>(light.kind));
    hash.add(light.casts_shadow);
  }
  for (int i = 0; i < 500; ++i) {  // a sky by its radiance in directions of a spiral
    const double z = 1 - 2 * (i + 0.5) / 500, r = std::sqrt(1 - z * z), phi = 2.399963 * i;
    for (const double value : scene.sky.radiance({r * std::cos(phi), z, r * std::sin(phi)})) hash.add(value);
  }
  for (const double value : scene.sky.mean()) hash.add(value);
  hash.add(scene.camera.view.data(), 16 * sizeof(float));
  for (const float v : {scene.camera.vertical_fov, scene.camera.lens_radius, scene.camera.focus}) hash.add(v);
  for (const int v : {scene.width, scene.height, scene.max_bounces, int{scene.shadows}}) hash.add(v);
  hash.add(options.seed);
  return hash.value();
}

/// Samples per pixel after which to look at the noise again: as many as would reach the wanted error, at most
/// twice as many as now. Even, so that both half-buffers have as many.
uint32_t goalFor(uint32_t samples, double error, double wanted) {
  const double ratio = error / wanted;
  const double needed = std::min(1.05 * samples * ratio * ratio, 2.0 * samples);
  return std::min(std::max(static_cast<uint32_t>(needed) / 2 * 2 + 2, samples + 2), kMostSamples);
}

std::string durationText(double seconds) {
  if (!(seconds < 1e6)) return "?";
  const auto whole = static_cast<int64_t>(seconds + 0.5);
  if (whole < 100) return fmt::format("{} s", whole);
  if (whole < 6000) return fmt::format("{} min", (whole + 30) / 60);
  return fmt::format("{:.1f} h", static_cast<double>(whole) / 3600);
}

/// The work on one picture: passes, progress, checkpoints.
class TraceJob {
 public:
  TraceJob(PathScene scene, const TraceOptions& options, const std::filesystem::path& file,
           const std::string& label)
      : options_(options),
        checkpoint_(file),
        label_(label),
        content_(contentOf(scene, options)),
        film_(scene.width, scene.height),
        tracer_(std::move(scene)),
        goal_(options.noise > 0 ? kFirstGoal : options.spp) {
    checkpoint_.replace_extension(".checkpoint");
  }

  std::string content() const { return fmt::format("{:016x}", content_); }
  const PathFilm& film() const { return film_; }
  const PathTracer& tracer() const { return tracer_; }
  double seconds() const { return seconds(start_); }

  void restore() {
    if (!std::filesystem::exists(checkpoint_)) return;
    const uint32_t goal = film_.restore(checkpoint_, content_);
    if (options_.noise > 0) goal_ = goal;
    spdlog::info("{}: continues after {:.1f} samples per pixel", label_, samplesPerPixel());
  }

  /// Whether the picture is finished; else it was interrupted, and a checkpoint is saved.
  bool run() {
    start_ = saved_ = std::chrono::steady_clock::now();
    before_ = film_.allSamples();
    while (true) {
      if (!reach(goal_)) {
        film_.save(checkpoint_, content_, goal_);
        return false;
      }
      if (options_.noise <= 0 || goal_ >= kMostSamples) break;
      error_ = film_.relativeError();
      if (error_ <= options_.noise) break;
      goal_ = goalFor(goal_, error_, options_.noise);
    }
    return true;
  }

  void removeCheckpoint() const {
    std::error_code ignored;
    std::filesystem::remove(checkpoint_, ignored);
  }

 private:
  static double seconds(std::chrono::steady_clock::time_point since) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - since).count();
  }
  double samplesPerPixel() const {
    return static_cast<double>(film_.allSamples()) / static_cast<double>(film_.size());
  }

  bool reach(uint32_t goal) {
    for (uint32_t level = 0; level < goal;) {
      level = std::min(level + kSamplesPerPass, goal);
      const uint64_t already = film_.allSamples();
      if (!tracer_.trace(film_, level, [&](uint64_t added) {
            show(already + added);
            return !g_interrupted;
          }))
        return false;
      if (seconds(saved_) < kCheckpointSeconds) continue;
      film_.save(checkpoint_, content_, goal_);
      saved_ = std::chrono::steady_clock::now();
    }
    return true;
  }

  void show(uint64_t samples) {
    double all = static_cast<double>(goal_) * static_cast<double>(film_.size());
    if (options_.noise > 0 && error_ > 0)  // the error falls with the root of the samples
      all = std::max(all, all * (error_ / options_.noise) * (error_ / options_.noise) / 2);
    const auto done = static_cast<double>(samples), own = static_cast<double>(samples - before_);
    const std::string left = own > 0 ? durationText((all - done) / own * seconds()) : "?";
    bar_.show(fmt::format("{}: {:.0f} samples per pixel{}, {} left", label_,
                          done / static_cast<double>(film_.size()),
                          error_ > 0 ? fmt::format(", noise {:.3g}", error_) : "", left),
              done / all);
  }

  const TraceOptions& options_;
  std::filesystem::path checkpoint_;
  std::string label_;
  uint64_t content_;
  PathFilm film_;
  PathTracer tracer_;
  uint32_t goal_;
  double error_ = 0;
  uint64_t before_ = 0;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now(), saved_ = start_;
  ProgressBar bar_;
};

constexpr const char *kContentAttribute = "strandcast.content", *kRequestAttribute = "strandcast.request",
                     *kErrorAttribute = "strandcast.error";

}  // namespace

TracedPicture tracePicture(PathScene scene, const TraceOptions& options, const Vec3& gains,
                           const std::filesystem::path& file, const std::string& label) {
  TracedPicture picture;
  picture.hairs = scene.hair.hairs();
  const std::string request =
      options.noise > 0 ? fmt::format("noise {:g}", options.noise) : fmt::format("spp {}", options.spp);
  TraceJob job(std::move(scene), options, file, label);
  picture.segments = job.tracer().geometry().segments();
  if (options.resume && std::filesystem::exists(file)) {
    const FloatImage earlier = readExr(file);
    const auto is = [&](const char* name, const std::string& text) {
      const auto found = earlier.attributes.find(name);
      return found != earlier.attributes.end() && found->second == text;
    };
    picture.was_there = is(kContentAttribute, job.content()) && is(kRequestAttribute, request);
  }
  if (picture.was_there) {
    picture.is_finished = true;
    spdlog::info("{} is there already", file.string());
    return picture;
  }
  if (options.resume) job.restore();
  picture.is_finished = job.run();
  picture.seconds = job.seconds();
  picture.samples = job.film().allSamples();
  picture.error = job.film().relativeError();
  FloatImage image = job.film().image();
  image.attributes = {{kContentAttribute, job.content()},
                      {kErrorAttribute, fmt::format("{:.6g}", picture.error)}};
  image.attributes[kRequestAttribute] = picture.is_finished ? request : "interrupted";
  writeExr(file, image);
  picture.image = job.film().developed(gains.array());
  if (picture.is_finished) job.removeCheckpoint();
  return picture;
}

}  // namespace strandcast
