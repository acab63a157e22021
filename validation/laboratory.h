#pragma once
#include <functional>
#include <memory>
#include <span>

#include "air/air_maker.h"
#include "core/simulation.h"

namespace strandcast {

/// What experiments are run with: the backend and the solver under test.
class Laboratory {
 public:
  /// How the backend of that name does the work of air.
  using Air = std::function<AirMaker(const std::string& backend)>;
  /// `backend` makes a backend for each simulation. `stopped` is asked at every step; where it says yes, the
  /// experiment is given up.
  Laboratory(
      std::function<std::unique_ptr<Backend>()> backend, SolverKind solver,
      std::function<bool()> stopped = [] { return false; },
      Air air = [](const std::string& name) { return cpuAir(name); })
      : backend_(std::move(backend)), solver_(solver), stopped_(std::move(stopped)), air_(std::move(air)) {}

  /// One substep per step, `rate` steps per second.
  Parameters parameters(double rate, float air_drag) const;
  /// With surroundings where the parameters or sources of wind ask for them.
  Simulation simulation(StrandModel model, const Parameters& parameters) const;
  Simulation simulation(StrandModel model, std::vector<RigidBody> bodies, const Parameters& parameters,
                        std::vector<WindSource> sources = {}) const;
  /// What the surroundings alone, made anew, give every vertex of hair in this state, m/s^2.
  std::vector<Vec3> accelerations(const StrandModel& model, const StrandState& state,
                                  const Parameters& parameters) const;
  /// Of the backend under test.
  AirMaker air() const { return air_(backend_()->name()); }
  /// Throws Stopped where the experiment is to be given up.
  void checkStopped() const {
    if (stopped_()) throw Stopped();
  }

  /// Steps until `seconds` more have passed; `after_step` may look at the simulation. Throws Stopped.
  void advance(Simulation& simulation, double seconds, const std::function<void()>& after_step = {}) const;
  /// The same under a motion of the head, given over the simulation's time.
  void advance(Simulation& simulation, double seconds, const std::function<Pose(double)>& motion,
               const std::function<void()>& after_step) const;

  struct Stopped {};

 private:
  std::function<std::unique_ptr<Backend>()> backend_;
  SolverKind solver_;
  std::function<bool()> stopped_;
  Air air_;
};

/// The newest positions of strand s.
std::span<const Vec3> strandOf(Simulation& simulation, size_t s);
/// The last of them.
Vec3 tipOf(Simulation& simulation, size_t s);
/// Of the edge that is stretched most now, %; not a number where a vertex has none.
double stretchOf(Simulation& simulation);
/// Root mean square of speeds, m/s; of strand s, over its vertices.
double rmsSpeedOf(std::span<const Vec3> velocities);
double rmsSpeedOf(const StrandModel& model, const StrandState& state, size_t s);
/// The largest of all strands now.
double fastestOf(Simulation& simulation);

}  // namespace strandcast
