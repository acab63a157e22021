// Path traced pictures: their options, the scene that a renderer's frame gives, and the work with progress,
// checkpoints and files.
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "light/path_tracer.h"
#include "options/picture_settings.h"
#include "render/camera.h"
#include "render/picture_geometry.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace strandcast {

struct TraceOptions {
  bool is_on = false;  ///< --method path_tracer
  uint32_t spp = 64;
  double noise = 0;  ///< relative error at which a picture is finished; 0: `spp` counts
  uint64_t seed = 1;
  int max_bounces = 0;
  std::filesystem::path sky;          ///< an OpenEXR file; empty: `sky_color`, else the ambient light
  std::vector<double> sky_color;      ///< radiance, 3 numbers; empty: not given
  double sky_intensity = 1;           ///< factor of both
  std::vector<double> absorption;     ///< per radius, 3 numbers, of all hairs; empty: by their colours
  double lens_radius = 0, focus = 0;  ///< m; focus 0: the camera's target
  bool resume = false;
  std::vector<CLI::Option*> options;  ///< that only path tracing uses
};

/// Adds --method and the options that belong to it. They are valid once parsed.
void addTraceOptions(CLI::App& app, TraceOptions& options);
/// Throws Error where an option of path tracing is given without --method path_tracer. Warns of options that
/// it does not use.
void checkTraceOptions(const TraceOptions& options, const PictureOptions& picture);

/// The sky that the options name. Throws Error as Sky::readPicture().
Sky skyOf(const TraceOptions& options);

/// The scene of a picture. `settings`: valid ones. Skin has a dielectric coat of index 1.4; the ground is
/// diffuse and fades into the backdrop, as the renderer's. Where the options name a sky, it is also the
/// backdrop.
PathScene pathScene(PictureGeometry geometry, const RenderSettings& settings, const Camera& camera,
                    const TraceOptions& options, const Sky& sky);

/// A finished or interrupted picture.
struct TracedPicture {
  Image image;  ///< tone mapped
  uint64_t samples = 0;
  double error = 0;  ///< PathFilm::relativeError()
  double seconds = 0;
  size_t hairs = 0, segments = 0;
  bool is_finished = false;
  bool was_there = false;  ///< an earlier run finished it
};

/// Traces a picture and writes `file`, an OpenEXR file; shows a progress bar that begins with `label`. Ctrl-C
/// (g_interrupted) ends it early and leaves a checkpoint beside the file, as does every minute of work; with
/// TraceOptions::resume it continues from there, and takes a finished picture as it is. Throws Error.
TracedPicture tracePicture(PathScene scene, const TraceOptions& options, const Vec3& gains,
                           const std::filesystem::path& file, const std::string& label);

}  // namespace strandcast
