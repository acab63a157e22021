#include "service/scene_simulation.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "collision/tree_broad_phase.h"
#include "core/backend.h"
#include "core/sag_free.h"
#include "gpu_compute/gpu_air.h"
#include "gpu_compute/gpu_backend.h"
#include "options/console.h"
#include "options/scene_loading.h"
#include "simd/simd_backend.h"

namespace strandcast {

std::vector<BackendInfo> knownBackends(const std::string& wanted) {
  std::vector<BackendInfo> of_processor = {simdBackendInfo(), referenceBackendInfo()};
  for (const BackendInfo& info : of_processor)
    if (info.name == wanted) return of_processor;
  of_processor.insert(of_processor.begin(), gpuBackendInfo());
  return of_processor;
}

AirFactory airOf(const std::string& backend, int threads) {
  return backend == "gpu" ? gpuAir() : cpuAir(backend, threads);
}

namespace {

Parameters sceneParameters(const Scene& scene, const Settings& settings) {
  Parameters parameters = scene.parameters;
  parameters.solver = settings.solver;
  for (const auto& [name, value] : settings.parameters) setParameter(parameters, name, value, "parameters");
  if (parameters.hair_radius < scene.parameters.hair_radius &&
      scene.parameters.hair_radius > Parameters().hair_radius)
    spdlog::warn(
        "hair_radius is {:g} m and the thickest material has {:g} m: hair that touches bodies partly enters "
        "them; leave hair_radius out to take it from the materials",
        parameters.hair_radius, scene.parameters.hair_radius);
  return parameters;
}

// Curls with hardly more than two vertices a turn alias and do not come to rest.
void warnOfSharpTurns(const StrandModel& model, const std::string& name) {
  constexpr double kSharp = 150;  // degrees, from edge to edge
  size_t sharp = 0;
  double sharpest = 0;
  for (size_t s = 0; s < model.strands(); ++s) {
    double most = 0;
    for (uint32_t j = model.offsets[s]; j + 1 < model.offsets[s + 1]; ++j)
      most = std::max(most, static_cast<double>(model.rest_strain[j].head<2>().norm()));
    const double degrees = 2 * std::atan(most / 2) * 180 / std::numbers::pi;
    sharp += degrees > kSharp;
    sharpest = std::max(sharpest, degrees);
  }
  if (sharp > 0)
    spdlog::warn(
        "{}: {} of {} strands bend by up to {:.0f} degrees at a vertex: too few vertices for their curls, "
        "which may never come to rest; give more (--vertices)",
        name, sharp, model.strands(), sharpest);
}

size_t partOfStrand(const Scene& scene, size_t strand) {
  const std::vector<uint16_t>& parts = scene.groom.strands.parts;
  return parts.empty() ? 0 : parts[strand];
}

// Warns of pins to other bones than the head: no program moves those, so the hair stays where they are.
void warnOfBonesThatStay(const std::vector<PinRule>& pins) {
  for (const PinRule& pin : pins)
    if (pin.bone != "head")
      spdlog::warn(
          "{}: bone '{}' does not move, so hair pinned to it stays in place: programs move only the bone "
          "'head'",
          pin.where, pin.bone);
}

// Counts these strands by part: "bangs 12, back 133".
std::string countByPart(const Scene& scene, std::span<const uint32_t> strands) {
  std::vector<size_t> counts(scene.part_names.size());
  for (const uint32_t s : strands) ++counts[partOfStrand(scene, s)];
  std::string text;
  for (size_t part = 0; part < counts.size(); ++part)
    if (counts[part] > 0)
      text += fmt::format("{}{} {}", text.empty() ? "" : ", ", scene.part_names[part], counts[part]);
  return text;
}

/// Logs the estimate before the work begins.
void logEstimate(const Scene& scene, const Settings& settings) {
  const HairEstimate estimate = estimateOfModel(scene, settings);
  if (estimate.isNotable())
    spdlog::info("{}: the model of {} strands, {} vertices takes {}", scene.name, estimate.strands,
                 estimate.vertices, estimate.text());
}

StrandModel modelOf(const Scene& scene, const Settings& settings, const Vec3& gravity, ProgressBar& bar) {
  bar.show("making the model", 0);
  StrandModel model = sceneModel(scene);
  bar.clear();
  if (settings.solver != SolverKind::kRod) return model;
  warnOfSharpTurns(model, scene.name);
  if (!settings.sag_free) return model;
  const SagFreeReport report = makeSagFree(model, gravity, [&](double part) {
    bar.show(fmt::format("making {} strands sag-free", model.strands()), 0.1 + 0.8 * part);
    return !g_interrupted.load();
  });
  if (g_interrupted) throw Interrupted();
  bar.clear();
  if (!report.stiffened.empty())
    spdlog::info(
        "{}: {} of {} strands stiffened to hold their shape under gravity ({}), up to x{:.0f}: strand {} of "
        "{}",
        scene.name, report.stiffened.size(), model.strands(), countByPart(scene, report.stiffened),
        report.largest_factor, report.stiffest, scene.part_names[partOfStrand(scene, report.stiffest)]);
  if (!report.unstable.empty())
    spdlog::warn("{}: {} strands cannot hold their shape under gravity, e.g. strand {}", scene.name,
                 report.unstable.size(), report.unstable.front());
  return model;
}

}  // namespace

Simulation makeSimulation(const Scene& scene, const Settings& settings) {
  const Parameters parameters = sceneParameters(scene, settings);
  warnOfBonesThatStay(scene.pins);
  std::unique_ptr<Backend> backend =
      createBackend(knownBackends(settings.backend), settings.backend, settings.threads, settings.solver);
  std::unique_ptr<ExternalForces> air_system;
  if (backend->takesAccelerations())
    air_system = airOf(backend->name(), settings.threads).make(withoutNames(settings.wind_sources));
  logEstimate(scene, settings);
  ProgressBar bar;
  StrandModel model = modelOf(scene, settings, parameters.gravity, bar);
  bar.show("loading the backend", 0.95);
  return Simulation(std::move(model), scene.bodies, parameters, std::move(backend), std::move(air_system),
                    makeTreeBroadPhase());
}

}  // namespace strandcast
