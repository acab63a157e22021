// One step of every backend and solver against the oracle. Steps of the rod among bodies are in
// bodies_conformance_test.cc, but for those with factors along strands.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <tuple>

#include "tests/conformance/conformance_fixture.h"
#include "tests/conformance/conformance_model.h"
#include "tests/thorough.h"

namespace strandcast {
namespace {

// m/s^2, as large as those of strong wind; they vary over some centimetres.
std::vector<Vec3> someAccelerations(const StrandModel& model) {
  std::vector<Vec3> out(model.vertices());
  for (size_t s = 0; s < model.strands(); ++s)
    for (uint32_t v = model.offsets[s]; v < model.offsets[s + 1]; ++v) {
      const Vec3 x = 20 * model.restPosition(s, v);
      out[v] = 20 * Vec3(std::sin(x.y()), std::cos(x.z()), std::sin(x.x() + 1));
    }
  return out;
}

TEST_P(Conformance, OneStepAgreesWithTheOracle) {
  const bool rod = parameters_.solver == SolverKind::kRod;
  const double tolerance = rod ? kRodOneStepTolerance : kOneStepTolerance;
  // Results of the oracle, shared by all backends; key: whether the rod, number of strands, case.
  static std::map<std::tuple<bool, size_t, std::string>, std::pair<StrandState, std::vector<double>>>
      known_steps;
  for (const size_t strands : {1, 7, 33, 257}) {
    if (kSanitized && strands > 33) continue;  // covers the same code
    StrandModel plain = awkwardModel(strands, 11), groomed = awkwardModel(strands, 11, groomedMaterials());
    Material rope;
    rope.tether = 1;
    const StrandModel tethered = awkwardModel(strands, 11, {rope});
    StrandModel tied = plain;
    tieToBones(tied);
    const StrandState without_bodies = disturbedState(plain, 12), with_bodies = disturbedState(plain, 15);
    plain.rest_distance = groomed.rest_distance =
        restDistancesAtStart(with_bodies, movingBodies(parameters_.time_step));
    const std::vector<Pose> still, bones_end = movedBones(), head_end = {movedHead()};
    for (const StepCase& c : kStepCases) {
      if (rod && c.bodies) continue;  // in bodies_conformance_test.cc
      const StrandState& from = c.bodies ? with_bodies : without_bodies;
      const Parameters parameters = parametersOf(c, parameters_);
      const StrandModel& model = c.groomed ? groomed : c.tied ? tied : c.tethered ? tethered : plain;
      const auto bodies = c.bodies ? movingBodies(parameters.time_step) : std::vector<MovingPrimitive>();
      const StepInput input{&parameters, {}, c.tied ? bones_end : c.moving_roots ? head_end : still, bodies};
      const double substep = parameters.time_step / parameters.substeps;
      const StrandState mine = stepped(model, from, input);
      const auto [known, is_new] = known_steps.try_emplace({rod, strands, c.name});
      auto& [truth, sensitivity] = known->second;
      if (is_new) {
        truth = oracleStep(model, from, input);
        sensitivity = sensitivities(model, from, truth, input, substep);
      }
      const std::vector<double> moved_by = errors(model, truth, from, substep);
      const std::vector<double> error = errors(model, mine, truth, substep);
      EXPECT_GT(*std::min_element(moved_by.begin(), moved_by.end()), 1e-3) << "the step must do something";
      size_t dense = 0;
      double worst = 0;
      for (size_t s = 0; s < strands; ++s) {
        if (rod && tooDense(model, s, substep)) {
          ++dense;
          continue;
        }
        const double limit =
            (rod && c.goal ? kGoalTolerance : tolerance) + kSensitivityFactor * sensitivity[s];
        worst = std::max(worst, error[s]);
        EXPECT_LT(error[s], limit) << "strand " << s << " of " << strands << ", " << c.name;
      }
      EXPECT_LT(dense, strands / 2 + 1) << "most strands must be compared";
      std::printf("             %3zu strands (%zu too dense), %s: %.1e of a strand's length\n", strands,
                  dense, c.name, worst);
      const std::span<const Vec3> guides = backend_->guides();
      EXPECT_TRUE(std::equal(guides.begin(), guides.end(), mine.positions.begin(), mine.positions.end()));
    }
  }
}

TEST_P(Conformance, AStepUnderAccelerationsAgreesWithTheOracle) {
  // One vertex count only: with accelerations a GPU compiles further programs per vertex count.
  StrandSet set;
  for (int n = 0; n < 20; ++n) {
    for (int i = 0; i < 17; ++i)
      set.positions.emplace_back(0.01f * static_cast<float>(n), 0.001f * static_cast<float>(i * i),
                                 0.01f * static_cast<float>(i));
    set.offsets.push_back(static_cast<uint32_t>(set.positions.size()));
  }
  const StrandModel model = makeStrandModel(set);
  const StrandState from = disturbedState(model, 12);
  const std::vector<Vec3> accelerations = someAccelerations(model);
  const std::vector<Pose> bones_end = {movedHead()};
  StepInput input{&parameters_, {}, bones_end};
  const StrandState without = oracleStep(model, from, input);
  input.accelerations = accelerations;
  const double substep = parameters_.time_step / parameters_.substeps;
  const StrandState truth = oracleStep(model, from, input), mine = stepped(model, from, input);
  const std::vector<double> error = errors(model, mine, truth, substep),
                            moved_by = errors(model, truth, without, substep);
  for (size_t s = 0; s < model.strands(); ++s) {
    EXPECT_LT(error[s], parameters_.solver == SolverKind::kRod ? kRodOneStepTolerance : kOneStepTolerance)
        << s;
    EXPECT_GT(moved_by[s], 1e-3) << s;
  }
}

// Damping, friction and masses that vary along strands: in a disturbed state without bodies, and among bodies
// from rest.
TEST_P(Conformance, AStepWithFactorsAlongStrandsAgreesWithTheOracle) {
  Material curved;
  curved.density_scale.knots = {{0, 1}, {1, 4}};
  curved.damping_curve.knots = {{0, 5}, {0.5f, 0}, {1, 2}};
  curved.friction_curve.knots = {{0, 0}, {1, 3}};
  const bool rod = parameters_.solver == SolverKind::kRod;
  parameters_.damping_time = 0.005f;
  // Strands of up to 31 vertices, for which a GPU compiles one program. gpu_rod_test covers the GPU's rod
  // without bodies.
  const StrandModel awkward = awkwardModel(48, 11);
  StrandSet set;
  for (size_t s = 0; s < awkward.strands(); ++s) {
    std::vector<Vec3> points;
    for (uint32_t v = awkward.offsets[s]; v < awkward.offsets[s + 1]; ++v)
      points.push_back(awkward.restPosition(s, v));
    if (points.size() <= 31) set.append(points);
  }
  StrandModel model = makeStrandModel(set, {curved});
  const std::vector<Pose> bones_end = {movedHead()};
  for (const bool among_bodies : {false, true}) {
    if (rod && !among_bodies && backend_->name() == "gpu") continue;
    const StrandState from = among_bodies ? restState(model, model.rest_roots) : disturbedState(model, 12);
    const auto bodies = among_bodies ? movingBodies(parameters_.time_step) : std::vector<MovingPrimitive>();
    model.rest_distance.clear();
    if (among_bodies) model.rest_distance = restDistancesAtStart(from, bodies);
    StrandModel without = model;
    without.damping_along.clear();
    without.friction_along.clear();
    const StepInput input{&parameters_, {}, bones_end, bodies};
    const double substep = parameters_.time_step / parameters_.substeps;
    const StrandState truth = oracleStep(model, from, input), mine = stepped(model, from, input);
    const std::vector<double> sensitivity = sensitivities(model, from, truth, input, substep),
                              error = errors(model, mine, truth, substep),
                              by_factors = errors(model, truth, oracleStep(without, from, input), substep);
    const double tolerance = !rod           ? kOneStepTolerance
                             : among_bodies ? kAmongBodiesTolerance
                                            : kRodOneStepTolerance;
    size_t compared = 0, off = 0, changed = 0;
    for (size_t s = 0; s < model.strands(); ++s) {
      if (rod && tooDense(model, s, substep, among_bodies ? kDensestAmongBodies : kDensestRod)) continue;
      ++compared;
      off += error[s] >= tolerance + kSensitivityFactor * sensitivity[s];
      changed += by_factors[s] > 20 * (tolerance + kSensitivityFactor * sensitivity[s]);
    }
    std::printf("             bodies %d: of %zu strands %zu are off, %zu moved otherwise by the factors\n",
                among_bodies, compared, off, changed);
    EXPECT_EQ(off, 0u);
    if (rod || among_bodies) {
      EXPECT_GT(changed, compared / 4);
    }
  }
}

}  // namespace
}  // namespace strandcast
