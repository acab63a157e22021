#pragma once
#include <gtest/gtest.h>

#include <cstdio>
#include <functional>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "core/backend.h"

namespace strandcast {

/// A backend with one of its solvers.
struct Contestant {
  std::string name;
  std::function<std::unique_ptr<Backend>()> create;
  std::string absent;  ///< why it cannot run; empty when it can
  SolverKind solver = SolverKind::kGaussSeidel;
  friend void PrintTo(const Contestant& c, std::ostream* out) { *out << c.name; }
};

/// Reference, each instruction set of the simd backend that this machine has, gpu.
std::vector<Contestant> contestants();

// One step against the oracle, as a part of a strand's length: a strand may differ by kOneStepTolerance and
// by kSensitivityFactor times what the oracle's own answer moves by when positions and velocities move by
// half a unit in the last place. The second counts where a strand is folded sharply under a body, where
// frames turn by much for little. Measured over all cases and backends: at most 3.1e-6.
constexpr double kOneStepTolerance = 5e-6;
// The rod's direct solves carry rounding from one end of a strand to the other. Its float form is held to
// this up to dt^2 B / (m l^2) of kDensestRod at every joint (measured: at most 4.5e-6 beyond the oracle's own
// sensitivity, 1.2e-5 on an H100). Denser strands are held by what must hold over many steps. Goals are
// rounded apart from positions, which is in no nudge (measured: 2.1e-5 on an H100).
constexpr double kRodOneStepTolerance = 2.5e-5, kGoalTolerance = 3e-5;
constexpr double kDensestRod = 30000;
// A vertex that grazes a body may touch it in one precision and not in the other; the length solve then holds
// it or does not. Of the rod's strands among bodies, how many may differ from the oracle by more than a
// rounding explains (kAmongBodiesTolerance), and by more than kGrazingTolerance: up to 0.1 and 0.02 % do on
// CPUs, 0.6 and 0.11 % on llvmpipe, 0.3 and 0.15 % on an H100.
constexpr double kDensestAmongBodies = 3000;
constexpr double kAmongBodiesTolerance = 4e-5, kGrazingTolerance = 5e-3;
constexpr double kMostOff = 0.0025, kMostOffOnGpu = 0.0075, kMostFar = 0.0015;
constexpr double kSensitivityFactor = 10;

class Conformance : public testing::TestWithParam<Contestant> {
 protected:
  void SetUp() override {
    if (!GetParam().absent.empty()) {
      std::printf("[ skipped  ] %s: %s\n", GetParam().name.c_str(), GetParam().absent.c_str());
      GTEST_SKIP() << GetParam().absent;
    }
    backend_ = GetParam().create();
    parameters_.solver = GetParam().solver;
    std::printf("[ ran on   ] %s: %s, solver %s\n", backend_->name().c_str(), backend_->device().c_str(),
                solverName(parameters_.solver).c_str());
  }

  StrandState stepped(const StrandModel& model, const StrandState& from, const StepInput& input,
                      int steps = 1) {
    backend_->load(model, from);
    if (!input.accelerations.empty()) backend_->expectAccelerations();
    for (int i = 0; i < steps; ++i) backend_->step(input);
    StrandState state;
    backend_->download(state);
    return state;
  }

  double mostOff() const { return backend_->name() == "gpu" ? kMostOffOnGpu : kMostOff; }

  std::unique_ptr<Backend> backend_;
  Parameters parameters_;
};

/// Vertices whose place or velocity is not finite.
size_t nonFinite(const StrandState& state);
/// Per strand, the largest distance between two states, positions and velocities x substep, as a part of its
/// length.
std::vector<double> errors(const StrandModel& model, const StrandState& a, const StrandState& b,
                           double substep);
/// The greatest dt^2 B / (m l^2) of a joint of strand s at this substep.
double stiffnessOf(const StrandModel& model, size_t s, double substep);
/// Whether the vertices of strand s are too dense for the rod's float form at this substep.
bool tooDense(const StrandModel& model, size_t s, double substep, double densest = kDensestRod);
StrandState oracleStep(const StrandModel& model, const StrandState& from, const StepInput& input);
/// Per strand, the most that the oracle's answer moves by when its input does, of a few nudges: of a strand
/// that slides under a body one alone may show a quarter of what the next shows.
std::vector<double> sensitivities(const StrandModel& model, const StrandState& from, const StrandState& truth,
                                  const StepInput& input, double substep);

/// What one step is taken with.
struct StepCase {
  const char* name;
  bool bodies, moving_roots, wind;
  bool goal = false, groomed = false, tied = false, tethered = false;
};
constexpr StepCase kStepCases[] = {{"gravity only", false, false, false},
                                   {"moving roots", false, true, false},
                                   {"bodies", true, false, false},
                                   {"bodies, moving roots, wind", true, true, true},
                                   {"goal pull, moving roots", false, true, false, true},
                                   {"groomed, bodies, moving roots, wind", true, true, true, true, true},
                                   {"tied to bones", false, true, false, false, false, true},
                                   {"tethers, moving roots", false, true, false, false, false, false, true}};

inline Parameters parametersOf(const StepCase& c, Parameters parameters) {
  if (c.wind) parameters.wind = Vec3(3, 0, 1);
  if (c.goal) parameters.goal_rate = 100;
  if (c.groomed) parameters.damping_time = 0.002f;
  return parameters;
}

}  // namespace strandcast
