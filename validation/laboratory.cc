#include "validation/laboratory.h"

#include <cmath>

#include "validation/suite.h"

namespace strandcast {

Parameters Laboratory::parameters(double rate, float air_drag) const {
  Parameters parameters;
  parameters.solver = solver_;
  parameters.time_step = static_cast<float>(1 / rate);
  parameters.substeps = 1;
  parameters.air_drag = air_drag;
  return parameters;
}

Simulation Laboratory::simulation(StrandModel model, const Parameters& parameters) const {
  return simulation(std::move(model), {}, parameters);
}

Simulation Laboratory::simulation(StrandModel model, std::vector<RigidBody> bodies,
                                  const Parameters& parameters, std::vector<WindSource> sources) const {
  std::unique_ptr<Backend> backend = backend_();
  std::unique_ptr<ExternalForces> air_system;
  if (needsExternalForces(parameters) || !sources.empty())
    air_system = air_(backend->name()).make(std::move(sources));
  return Simulation(std::move(model), std::move(bodies), parameters, std::move(backend),
                    std::move(air_system));
}

std::vector<Vec3> Laboratory::accelerations(const StrandModel& model, const StrandState& state,
                                            const Parameters& parameters) const {
  const std::unique_ptr<Backend> backend = backend_();
  const std::unique_ptr<ExternalForces> air_system = air_(backend->name()).make({});
  backend->load(model, state);
  air_system->configure(model, parameters, *backend);
  StepInput input;
  input.parameters = &parameters;
  air_system->step(input, *backend);
  const std::span<const Vec3> out = air_system->accelerations(), places = backend->guides();
  std::vector<Vec3> accelerations(out.begin(), out.end());
  for (size_t v = 0; v < accelerations.size(); ++v)  // the air system skips a strand that diverged
    if (!places[v].allFinite()) accelerations[v] = places[v];
  return accelerations;
}

void Laboratory::advance(Simulation& simulation, double seconds,
                         const std::function<void()>& after_step) const {
  const Pose still = simulation.headPose();
  advance(
      simulation, seconds, [&](double) { return still; }, after_step);
}

void Laboratory::advance(Simulation& simulation, double seconds, const std::function<Pose(double)>& motion,
                         const std::function<void()>& after_step) const {
  const double step = simulation.parameters().time_step;
  const auto steps = std::lround(seconds / step);
  const double start = simulation.time();
  for (long i = 1; i <= steps; ++i) {
    checkStopped();
    simulation.setHeadPose(motion(start + static_cast<double>(i) * step));
    simulation.step();
    if (after_step) after_step();
  }
}

std::span<const Vec3> strandOf(Simulation& simulation, size_t s) {
  const StrandModel& model = simulation.model();
  return simulation.guides().subspan(model.offsets[s], model.verticesOf(s));
}

Vec3 tipOf(Simulation& simulation, size_t s) { return strandOf(simulation, s).back(); }

double stretchOf(Simulation& simulation) {
  const Measurement now = simulation.measure();
  return now.non_finite > 0 ? std::nan("") : 100 * now.max_stretch;
}

double rmsSpeedOf(std::span<const Vec3> velocities) {
  double squares = 0;
  for (const Vec3& velocity : velocities) squares += velocity.cast<double>().squaredNorm();
  return std::sqrt(squares / static_cast<double>(velocities.size()));
}

double rmsSpeedOf(const StrandModel& model, const StrandState& state, size_t s) {
  return rmsSpeedOf(std::span(state.velocities).subspan(model.offsets[s], model.verticesOf(s)));
}

double fastestOf(Simulation& simulation) {
  const StrandState state = simulation.state();
  double fastest = 0;
  for (size_t s = 0; s < simulation.model().strands(); ++s)
    fastest = worse(fastest, rmsSpeedOf(simulation.model(), state, s));
  return fastest;
}

}  // namespace strandcast
