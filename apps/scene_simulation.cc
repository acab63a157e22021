#include "apps/scene_simulation.h"

#include <spdlog/spdlog.h>

#include "apps/backends.h"
#include "collision/tree_broad_phase.h"
#include "core/backend_registry.h"
#include "core/sag_free.h"

namespace strandcast {
namespace {

Parameters sceneParameters(const Scene& scene, const Settings& settings) {
  Parameters parameters = scene.parameters;
  parameters.solver = settings.solver;
  for (const auto& [name, value] : settings.parameters) setParameter(parameters, name, value, "parameters");
  return parameters;
}

StrandModel modelOf(const Scene& scene, const Settings& settings, const Vec3& gravity) {
  StrandModel model = sceneModel(scene);
  if (!settings.sag_free || settings.solver != SolverKind::kRod) return model;
  const SagFreeReport report = makeSagFree(model, gravity);
  if (!report.stiffened.empty())
    spdlog::info("{}: {} of {} strands stiffened, up to x{:.0f}, to hold their shape under gravity",
                 scene.name, report.stiffened.size(), model.strands(), report.largest_factor);
  if (!report.unstable.empty())
    spdlog::warn("{}: {} strands cannot hold their shape under gravity, e.g. strand {}", scene.name,
                 report.unstable.size(), report.unstable.front());
  return model;
}

}  // namespace

Simulation makeSimulation(const Scene& scene, const Settings& settings) {
  const Parameters parameters = sceneParameters(scene, settings);
  std::unique_ptr<Backend> backend =
      createBackend(knownBackends(), settings.backend, settings.threads, settings.solver);
  std::unique_ptr<Surroundings> surroundings;
  if (backend->takesAccelerations())
    surroundings = airOf(backend->name(), settings.threads).surroundings(settings.wind_sources);
  return Simulation(modelOf(scene, settings, parameters.gravity), scene.bodies, parameters,
                    std::move(backend), std::move(surroundings), makeTreeBroadPhase());
}

}  // namespace strandcast
