#pragma once
#include <functional>
#include <memory>
#include <span>

#include "air/air_system.h"
#include "core/simulation.h"

namespace strandcast {

/// Environment of experiments: the backend and the solver under test.
class Laboratory {
 public:
  /// Returns the air maker of the backend with this name.
  using Air = std::function<AirFactory(const std::string& backend)>;
  /// `backend` makes a backend for each simulation. `stopped` is called at every step; the experiment is
  /// aborted when it returns true.
  Laboratory(
      std::function<std::unique_ptr<Backend>()> backend, SolverKind solver,
      std::function<bool()> stopped = [] { return false; },
      Air air = [](const std::string& name) { return cpuAir(name); })
      : backend_(std::move(backend)), solver_(solver), stopped_(std::move(stopped)), air_(std::move(air)) {}

  /// Parameters with one substep per step and `rate` steps per second; air_drag: 1/s.
  Parameters parameters(double rate, float air_drag) const;
  /// Makes a simulation, with an air system where parameters or wind sources need one.
  Simulation simulation(StrandModel model, const Parameters& parameters) const;
  Simulation simulation(StrandModel model, std::vector<RigidBody> bodies, const Parameters& parameters,
                        std::vector<WindSource> sources = {}) const;
  /// Accelerations of all vertices, m/s^2, that a new air system gives to hair in this state.
  std::vector<Vec3> accelerations(const StrandModel& model, const StrandState& state,
                                  const Parameters& parameters) const;
  /// Air maker of the backend under test.
  AirFactory air() const { return air_(backend_()->name()); }
  /// Throws Stopped when the experiment is to be aborted.
  void checkStopped() const {
    if (stopped_()) throw Stopped();
  }

  /// Steps for `seconds`; calls `after_step` after each step. Throws Stopped.
  void advance(Simulation& simulation, double seconds, const std::function<void()>& after_step = {}) const;
  /// The same with a motion of the head, a function of the simulation's time in s.
  void advance(Simulation& simulation, double seconds, const std::function<Pose(double)>& motion,
               const std::function<void()>& after_step) const;

  struct Stopped {};

 private:
  std::function<std::unique_ptr<Backend>()> backend_;
  SolverKind solver_;
  std::function<bool()> stopped_;
  Air air_;
};

/// Current positions of strand s, m.
std::span<const Vec3> strandOf(Simulation& simulation, size_t s);
/// Current position of the tip of strand s, m.
Vec3 tipOf(Simulation& simulation, size_t s);
/// Largest stretch of an edge now, %; NaN where a position is NaN.
double stretchOf(Simulation& simulation);
/// Root mean square of speeds, m/s; the second form of the vertices of strand s.
double rmsSpeedOf(std::span<const Vec3> velocities);
double rmsSpeedOf(const StrandModel& model, const StrandState& state, size_t s);
/// Largest rmsSpeedOf() of all strands now, m/s.
double fastestOf(Simulation& simulation);

}  // namespace strandcast
