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

/// A backend with one of its solvers: the parameter of the fixture.
struct BackendCase {
  std::string name;
  std::function<std::unique_ptr<Backend>()> create;
  std::string absent;  ///< reason why it cannot run; empty when it can
  SolverKind solver = SolverKind::kGaussSeidel;
  friend void PrintTo(const BackendCase& c, std::ostream* out) { *out << c.name; }
};

/// The reference backend, simd with each instruction set of this machine, and gpu, with each of their
/// solvers.
std::vector<BackendCase> backendCases();

// Tolerance of one step against the oracle, as a part of a strand's length: kOneStepTolerance plus
// kSensitivityFactor times the strand's sensitivity. The sensitivity is the change of the oracle's result
// when positions and velocities change by half a unit in the last place. It matters for strands folded
// sharply under a body, whose frames are ill-conditioned. Measured over all cases and backends: at
// most 3.1e-6.
constexpr double kOneStepTolerance = 5e-6;
// Direct solves of the rod propagate rounding along the whole strand. This tolerance applies to strands with
// dt^2 B / (m l^2) up to kDensestRod at every joint (measured: at most 4.5e-6 beyond the oracle's own
// sensitivity, 1.2e-5 on an H100). Denser strands are tested by invariants over many steps. Goals are rounded
// separately from positions, which nudges do not cover (measured: 2.1e-5 on an H100).
constexpr double kRodOneStepTolerance = 2.5e-5, kGoalTolerance = 3e-5;
constexpr double kDensestRod = 30000;
// A vertex that grazes a body may touch it in one precision and not in the other; the length solve then holds
// it or does not. kMaxOffShare and kMaxFarShare are the shares of the rod's strands among bodies that may
// differ from the oracle by more than kAmongBodiesTolerance (plus sensitivity) and by more than
// kGrazingTolerance. Measured: up to 0.1 and 0.02 % on CPUs, 0.6 and 0.11 % on llvmpipe, 0.3 and 0.15 % on an
// H100.
constexpr double kDensestAmongBodies = 3000;
constexpr double kAmongBodiesTolerance = 4e-5, kGrazingTolerance = 5e-3;
constexpr double kMaxOffShare = 0.0025, kMaxOffShareOnGpu = 0.0075, kMaxFarShare = 0.0015;
constexpr double kSensitivityFactor = 10;

class Conformance : public testing::TestWithParam<BackendCase> {
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
    if (!input.accelerations.empty()) backend_->prepareAccelerations();
    for (int i = 0; i < steps; ++i) backend_->step(input);
    StrandState state;
    backend_->download(state);
    return state;
  }

  double maxOffShare() const { return backend_->name() == "gpu" ? kMaxOffShareOnGpu : kMaxOffShare; }

  std::unique_ptr<Backend> backend_;
  Parameters parameters_;
};

/// Number of vertices whose position or velocity is not finite.
size_t nonFinite(const StrandState& state);
/// Per strand, the largest distance between two states over its vertices, of positions and of velocities x
/// substep (s), as a part of the strand's length.
std::vector<double> errors(const StrandModel& model, const StrandState& a, const StrandState& b,
                           double substep);
/// The greatest dt^2 B / (m l^2) of a joint of strand s, with dt = `substep`, s.
double stiffnessOf(const StrandModel& model, size_t s, double substep);
/// Whether stiffnessOf() strand s exceeds `densest`: too stiff for the one-step tolerance in float.
bool tooDense(const StrandModel& model, size_t s, double substep, double densest = kDensestRod);
StrandState oracleStep(const StrandModel& model, const StrandState& from, const StepInput& input);
/// Per strand, the largest change of the oracle's result over kNudges nudges of its input. Several, because
/// for a strand that slides under a body one nudge may show a quarter of the next one's change.
std::vector<double> sensitivities(const StrandModel& model, const StrandState& from, const StrandState& truth,
                                  const StepInput& input, double substep);

/// Features of the input of one step.
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
