#include "tests/conformance/conformance_fixture.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "gpu_compute/gpu_backend.h"
#include "simd/simd_backend.h"
#include "tests/conformance/conformance_model.h"

namespace strandcast {

std::vector<BackendCase> backendCases() {
  std::vector<BackendCase> list;
  auto add = [&](const std::string& name, const BackendInfo& info, const auto& create) {
    for (const SolverKind solver : info.solvers)
      list.push_back({name + "_" + solverName(solver), create, info.available ? "" : info.reason, solver});
  };
  add("reference", referenceBackendInfo(), [] { return makeReferenceBackend(); });
  for (const std::string& target : simdTargets())
    add("simd_" + target, simdBackendInfo(), [target] { return makeSimdBackend(2, target); });
  add("gpu", gpuBackendInfo(), [] { return makeGpuBackend(); });
  return list;
}

size_t nonFinite(const StrandState& state) {
  size_t count = 0;
  for (size_t i = 0; i < state.positions.size(); ++i)
    count += !state.positions[i].allFinite() || !state.velocities[i].allFinite();
  return count;
}

std::vector<double> errors(const StrandModel& model, const StrandState& a, const StrandState& b,
                           double substep) {
  std::vector<double> out(model.strands());
  for (size_t s = 0; s < model.strands(); ++s) {
    const double length = arcLength({model.rest_local.data() + model.offsets[s], model.verticesOf(s)});
    for (uint32_t v = model.offsets[s]; v < model.offsets[s + 1]; ++v) {
      const double position = (a.positions[v] - b.positions[v]).norm();
      const double velocity = (a.velocities[v] - b.velocities[v]).norm() * substep;
      const double error = std::max(position, velocity) / length;
      out[s] = std::isfinite(position + velocity) ? std::max(out[s], error)
                                                  : std::numeric_limits<double>::infinity();
    }
  }
  return out;
}

double stiffnessOf(const StrandModel& model, size_t s, double substep) {
  double most = 0;
  for (uint32_t j = model.offsets[s]; j + 1 < model.offsets[s + 1]; ++j) {
    const double length = (model.rest_local[j + 1] - model.rest_local[j]).norm();
    most = std::max(most, substep * substep * model.bend[j] / (model.mass[j + 1] * length * length));
  }
  return most;
}
bool tooDense(const StrandModel& model, size_t s, double substep, double densest) {
  return stiffnessOf(model, s, substep) > densest;
}

StrandState oracleStep(const StrandModel& model, const StrandState& from, const StepInput& input) {
  auto oracle = makeOracleBackend();
  oracle->load(model, from);
  if (!input.accelerations.empty()) oracle->prepareAccelerations();
  oracle->step(input);
  StrandState state;
  oracle->download(state);
  return state;
}

std::vector<double> sensitivities(const StrandModel& model, const StrandState& from, const StrandState& truth,
                                  const StepInput& input, double substep) {
  std::vector<double> out(model.strands());
  for (uint32_t seed = 1; seed <= kNudges; ++seed) {
    const auto moved = errors(model, truth, oracleStep(model, nudged(from, seed), input), substep);
    for (size_t s = 0; s < out.size(); ++s) out[s] = std::max(out[s], moved[s]);
  }
  return out;
}

}  // namespace strandcast
