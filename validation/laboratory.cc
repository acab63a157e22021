#include "validation/laboratory.h"

#include <cmath>

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
                                  const Parameters& parameters) const {
  return Simulation(std::move(model), std::move(bodies), parameters, backend_());
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
    if (stopped_()) throw Stopped();
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

}  // namespace strandcast
