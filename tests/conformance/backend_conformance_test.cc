// One body of tests for every backend and solver: reference, each instruction set of the simd backend that
// this machine has, gpu.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <limits>
#include <map>
#include <ostream>
#include <tuple>

#include "core/measure.h"
#include "core/simulation.h"
#include "gpu_compute/gpu_backend.h"
#include "simd/simd_backend.h"
#include "tests/conformance/conformance_model.h"
#include "tests/sanitized.h"
#include "tests/thorough.h"

namespace strandcast {
namespace {

struct Contestant {
  std::string name;
  std::function<std::unique_ptr<Backend>()> create;
  std::string absent;  ///< why it cannot run; empty when it can
  SolverKind solver = SolverKind::kGaussSeidel;
  friend void PrintTo(const Contestant& c, std::ostream* out) { *out << c.name; }
};

std::vector<Contestant> contestants() {
  std::vector<Contestant> list;
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

size_t nonFinite(const StrandState& state) {
  size_t count = 0;
  for (size_t i = 0; i < state.positions.size(); ++i)
    count += !state.positions[i].allFinite() || !state.velocities[i].allFinite();
  return count;
}

// Per strand, the largest distance between two states, positions and velocities x substep, as a part of its
// length.
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

// The greatest dt^2 B / (m l^2) of a joint of strand s at this substep.
double stiffnessOf(const StrandModel& model, size_t s, double substep) {
  double most = 0;
  for (uint32_t j = model.offsets[s]; j + 1 < model.offsets[s + 1]; ++j) {
    const double length = (model.rest_local[j + 1] - model.rest_local[j]).norm();
    most = std::max(most, substep * substep * model.bend[j] / (model.mass[j + 1] * length * length));
  }
  return most;
}
// Whether the vertices of strand s are too dense for the rod's float form at this substep.
bool tooDense(const StrandModel& model, size_t s, double substep, double densest = kDensestRod) {
  return stiffnessOf(model, s, substep) > densest;
}

StrandState oracleStep(const StrandModel& model, const StrandState& from, const StepInput& input) {
  auto oracle = makeOracleBackend();
  oracle->load(model, from);
  if (!input.accelerations.empty()) oracle->expectAccelerations();
  oracle->step(input);
  StrandState state;
  oracle->download(state);
  return state;
}

// Per strand, the most that the oracle's answer moves by when its input does, of a few nudges: of a strand
// that slides under a body one alone may show a quarter of what the next shows.
std::vector<double> sensitivities(const StrandModel& model, const StrandState& from, const StrandState& truth,
                                  const StepInput& input, double substep) {
  std::vector<double> out(model.strands());
  for (uint32_t seed = 1; seed <= kNudges; ++seed) {
    const auto moved = errors(model, truth, oracleStep(model, nudged(from, seed), input), substep);
    for (size_t s = 0; s < out.size(); ++s) out[s] = std::max(out[s], moved[s]);
  }
  return out;
}

struct Case {
  const char* name;
  bool bodies, moving_roots, wind;
  bool goal = false, groomed = false, tied = false, tethered = false;
};
constexpr Case kCases[] = {{"gravity only", false, false, false},
                           {"moving roots", false, true, false},
                           {"bodies", true, false, false},
                           {"bodies, moving roots, wind", true, true, true},
                           {"goal pull, moving roots", false, true, false, true},
                           {"groomed, bodies, moving roots, wind", true, true, true, true, true},
                           {"tied to bones", false, true, false, false, false, true},
                           {"tethers, moving roots", false, true, false, false, false, false, true}};

Parameters parametersOf(const Case& c, Parameters parameters) {
  if (c.wind) parameters.wind = Vec3(3, 0, 1);
  if (c.goal) parameters.goal_rate = 100;
  if (c.groomed) parameters.damping_time = 0.002f;
  return parameters;
}

// m/s^2, as strong wind gives; it changes over some centimetres.
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
  // What the oracle says, which is the same for every backend: by solver, strands, case.
  static std::map<std::tuple<bool, size_t, std::string>, std::pair<StrandState, std::vector<double>>>
      known_steps;
  for (const size_t strands : {1, 7, 33, 257}) {
    if (kSanitized && strands > 33) continue;  // the same code
    StrandModel plain = awkwardModel(strands, 11), groomed = awkwardModel(strands, 11, groomedMaterials());
    Material rope;
    rope.tether = 1;
    const StrandModel tethered = awkwardModel(strands, 11, {rope});
    StrandModel tied = plain;
    tieToBones(tied);
    const StrandState without_bodies = disturbedState(plain, 12), with_bodies = disturbedState(plain, 15);
    plain.rest_distance = groomed.rest_distance =
        leftWhereTheyStart(with_bodies, movingBodies(parameters_.time_step));
    const std::vector<Pose> still, bones_end = movedBones(), head_end = {movedHead()};
    for (const Case& c : kCases) {
      if (rod && c.bodies) continue;  // those are scored below
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

// A step among bodies, as the oracle has it: the same for every backend.
struct StepAmongBodies {
  StrandModel model;
  StrandState from, truth;
  Parameters parameters;
  ShapeData shapes;
  std::vector<MovingPrimitive> bodies;
  std::vector<Pose> bones_end;
  std::vector<double> sensitivity, touched;  // touched: by how much the bodies move a strand

  StepInput input() const { return {&parameters, {}, bones_end, bodies, {}, &shapes}; }
  double substep() const { return parameters.time_step / parameters.substeps; }
  void askTheOracle() {
    model.rest_distance = leftWhereTheyStart(from, bodies, shapes.words);
    truth = oracleStep(model, from, input());
    sensitivity = sensitivities(model, from, truth, input(), substep());
    touched = errors(model, truth, oracleStep(model, from, {&parameters, {}, bones_end}), substep());
  }
};
std::vector<StepAmongBodies> stepsAmongBodies(const Parameters& common) {
  std::vector<StepAmongBodies> out;
  for (uint32_t seed = 1; seed <= 8; ++seed)
    for (const Case& c : kCases) {
      if (!c.bodies) continue;
      StepAmongBodies step;
      step.model = c.groomed ? awkwardModel(257, 11, groomedMaterials()) : awkwardModel(257, 11);
      step.from = disturbedState(step.model, seed);
      step.bodies = movingBodies(common.time_step);
      if (c.moving_roots) step.bones_end = {movedHead()};
      step.parameters = parametersOf(c, common);
      step.askTheOracle();
      out.push_back(std::move(step));
    }
  return out;
}

// Strands of the rod that are thrown at bodies may touch them or not by a rounding, which no few nudges of
// the oracle's input foresee. So these are counted, over states that nobody has chosen.
struct Disagreement {
  size_t compared = 0, off = 0, far = 0;
  void add(const StepAmongBodies& step, const std::vector<double>& error) {
    for (size_t s = 0; s < error.size(); ++s) {
      if (tooDense(step.model, s, step.substep(), kDensestAmongBodies)) continue;
      ++compared;
      off += error[s] >= kAmongBodiesTolerance + kSensitivityFactor * step.sensitivity[s];
      if (error[s] < kGrazingTolerance) continue;
      ++far;
      std::printf("             strand %zu, stiffness %.0f, is off by %.1e\n", s,
                  stiffnessOf(step.model, s, step.substep()), error[s]);
    }
  }
  void expectLittle(double most_off) const {
    std::printf("             of %zu strands %zu are off, %zu of them far\n", compared, off, far);
    EXPECT_LT(static_cast<double>(off), most_off * static_cast<double>(compared));
    EXPECT_LT(static_cast<double>(far), kMostFar * static_cast<double>(compared));
  }
};

TEST_P(Conformance, NearlyAllStrandsAmongBodiesAgreeWithTheOracle) {
  if (parameters_.solver != SolverKind::kRod) return;
  if (kSanitized) GTEST_SKIP() << "it counts strands; OneStepWithEveryKindOfBody runs the same code";
  if (backend_->name() == "gpu" && !thorough()) GTEST_SKIP() << kLeftToThorough;
  static const std::vector<StepAmongBodies> steps = stepsAmongBodies(parameters_);
  Disagreement all;
  for (const StepAmongBodies& step : steps)
    all.add(step,
            errors(step.model, stepped(step.model, step.from, step.input()), step.truth, step.substep()));
  all.expectLittle(mostOff());
}

TEST_P(Conformance, AStepUnderAccelerationsAgreesWithTheOracle) {
  // One vertex count: with accelerations, a GPU compiles programs of their own.
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

// Damping and friction that differ along strands, and masses; without bodies and, at rest but for them, among
// some.
TEST_P(Conformance, AStepWithFactorsAlongStrandsAgreesWithTheOracle) {
  Material curved;
  curved.density_scale.knots = {{0, 1}, {1, 4}};
  curved.damping_curve.knots = {{0, 5}, {0.5f, 0}, {1, 2}};
  curved.friction_curve.knots = {{0, 0}, {1, 3}};
  const bool rod = parameters_.solver == SolverKind::kRod;
  parameters_.damping_time = 0.005f;
  // Those of up to 31 vertices, for which a GPU compiles one program; without bodies gpu_rod_test has its
  // rod.
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
    if (among_bodies) model.rest_distance = leftWhereTheyStart(from, bodies);
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

// Bodies of every kind, each alone, so that every strand that differs is the doing of one kind; the rod from
// several states, for its strands are counted. One state has all of the code for a sanitizer.
using StepsOfKind = std::vector<StepAmongBodies>;
std::vector<StepsOfKind> stepsOfEachKind(const Parameters& common) {
  std::vector<StepsOfKind> out(kFurtherKinds);
  const uint32_t states = common.solver == SolverKind::kRod && !kSanitized ? 8 : 1;
  for (int kind = 0; kind < kFurtherKinds; ++kind)
    for (uint32_t state = 0; state < states; ++state) {
      StepAmongBodies& step = out[static_cast<size_t>(kind)].emplace_back();
      step.model = awkwardModel(65, 17);
      step.from = disturbedState(step.model, 18 + state);
      step.parameters = common;
      step.bodies = {furtherBody(kind, common.time_step, step.shapes)};
      step.bones_end = {movedHead()};
      step.askTheOracle();
    }
  return out;
}
TEST_P(Conformance, OneStepWithEveryKindOfBodyAgreesWithTheOracle) {
  static std::map<SolverKind, std::vector<StepsOfKind>> known;
  std::vector<StepsOfKind>& kinds = known[parameters_.solver];
  if (kinds.empty()) kinds = stepsOfEachKind(parameters_);
  const bool rod = parameters_.solver == SolverKind::kRod;
  Disagreement all;
  for (const StepsOfKind& steps : kinds) {
    const auto kind = &steps - kinds.data();
    size_t strands = 0, moved_by_body = 0;
    double worst = 0;
    for (const StepAmongBodies& step : steps) {
      const std::vector<double> error =
          errors(step.model, stepped(step.model, step.from, step.input()), step.truth, step.substep());
      strands += step.model.strands();
      for (size_t s = 0; s < error.size(); ++s) {
        if (rod && tooDense(step.model, s, step.substep())) continue;
        moved_by_body += step.touched[s] > 1e-3;
        worst = std::max(worst, error[s]);
        if (!rod) {
          EXPECT_LT(error[s], kOneStepTolerance + kSensitivityFactor * step.sensitivity[s])
              << "strand " << s << ", kind " << kind;
        }
      }
      if (rod) all.add(step, error);
    }
    std::printf("             kind %td moves %zu strands of %zu: %.1e of a strand's length\n", kind,
                moved_by_body, strands, worst);
    EXPECT_GT(moved_by_body, strands / 8);
  }
  // Of the strands of one state that much would be less than one.
  if (rod && !kSanitized) all.expectLittle(mostOff());
}

// Hair that stands up from a floor under a ball that covers roots of it and rises by a millimetre in the
// step.
TEST_P(Conformance, HairNearRootsThatABodyCoversAgreesWithTheOracle) {
  constexpr float kBall = 0.04f;  // m
  constexpr int kSide = 8, kRising = 30;
  StrandSet set;
  for (int s = 0; s < kSide * kSide; ++s) {
    const Vec3 root(0.01f * static_cast<float>(s % kSide - kSide / 2) + 1e-3f, 0,
                    0.01f * static_cast<float>(s / kSide - kSide / 2) + 2e-3f);
    const int vertices = s % 3 == 0 ? 9 : 17;
    std::vector<Vec3> points;
    for (int i = 0; i < vertices; ++i)
      points.push_back(root + Vec3(0.02f, 0.12f, 0.01f) *
                                  (static_cast<float>(i) / static_cast<float>(vertices - 1)));
    set.append(points);
  }
  const StrandModel model = makeStrandModel(set);
  const ContactPrimitive ball{PrimitiveKind::kSphere, Vec3::Zero(), Vec3::UnitY(), kBall, 0.3f};
  auto bodiesAt = [&](int step) {
    const auto pose = [](int at) {
      return Pose{Vec3(0, 1e-3f * static_cast<float>(at - kRising) - 0.01f, 0), Quat::Identity()};
    };
    return std::vector<MovingPrimitive>{moved(ball, pose(step), pose(step + 1), parameters_.time_step)};
  };
  StrandState from = restState(model, model.rest_roots);
  for (int step = 0; step < kRising; ++step)
    from = oracleStep(model, from, {&parameters_, {}, {}, bodiesAt(step)});
  const std::vector<MovingPrimitive> bodies = bodiesAt(kRising);
  const StepInput input{&parameters_, {}, {}, bodies};
  const double substep = parameters_.time_step / parameters_.substeps;
  const StrandState truth = oracleStep(model, from, input);
  const std::vector<double> error = errors(model, stepped(model, from, input), truth, substep),
                            sensitivity = sensitivities(model, from, truth, input, substep);
  const double tolerance = parameters_.solver == SolverKind::kRod ? kAmongBodiesTolerance : kOneStepTolerance;
  double worst = 0;
  size_t in_ball = 0, out_of_it = 0;
  for (size_t s = 0; s < model.strands(); ++s) {
    worst = std::max(worst, error[s]);
    EXPECT_LT(error[s], tolerance + kSensitivityFactor * sensitivity[s]) << "strand " << s;
    const uint32_t root = model.offsets[s], tip = model.offsets[s + 1] - 1;
    in_ball += signedDistance(bodies[0], truth.positions[root + 1], {}) < -2e-3f;
    out_of_it += signedDistance(bodies[0], truth.positions[tip], {}) > 0;
  }
  std::printf("             %zu strands of %zu start in the ball: %.1e of a strand's length\n", in_ball,
              model.strands(), worst);
  EXPECT_GT(in_ball, 10u);
  EXPECT_EQ(out_of_it, model.strands());
}

// Sixty balls about the head and in the hair, most of them out of a strand's reach; the head moves. Only
// strands of the rod are known to stay within reach.
TEST_P(Conformance, ListsOfNearBodiesChangeNoBit) {
  StrandModel model = awkwardModel(65, 19), tied = model;
  tieToBones(tied);
  std::vector<RigidBody> bodies;
  std::mt19937 random(20);
  std::uniform_real_distribution<float> place(-1, 1);
  for (int i = 0; i < 60; ++i) {
    RigidBody ball{
        {{PrimitiveKind::kSphere, Vec3(place(random), place(random), place(random)), Vec3::UnitY(), 0.03f}}};
    bodies.push_back(ball);
  }
  for (const StrandModel* one : {&model, &tied}) {
    Simulation simulation(*one, bodies, parameters_, GetParam().create());
    backend_->load(*one, simulation.state());
    size_t listed = 0, possible = 0;
    for (int i = 1; i <= 3; ++i) {
      simulation.setHeadPose(
          {Vec3(0.005f * i, 0, 0), Quat(Eigen::AngleAxisf(0.01f * i, Eigen::Vector3f::UnitY()))});
      backend_->upload(simulation.state());
      StepInput input = simulation.nextInput();
      ASSERT_EQ(input.near != nullptr, parameters_.solver == SolverKind::kRod);
      if (input.near == nullptr) return;
      listed += input.near->bodies.size();
      possible += (input.near->offsets.size() - 1) * bodies.size();
      input.near = nullptr;
      backend_->step(input);
      simulation.step();
      StrandState state;
      backend_->download(state);
      EXPECT_EQ(stateHash(state), stateHash(simulation.state())) << "step " << i;
    }
    EXPECT_LE(listed, one == &model ? possible / 2 : possible);
  }
}

TEST_P(Conformance, ContactForcesAreForgottenWithTheirBodies) {
  const StrandModel model = awkwardModel(33, 23);
  const StrandState from = restState(model, model.rest_roots);
  const auto bodies = movingBodies(parameters_.time_step);
  backend_->load(model, from);
  const StepInput with{&parameters_, {}, {}, bodies}, without{&parameters_};
  const auto pressed = [&] {
    StrandState state;
    backend_->download(state);
    return std::any_of(state.contacts.begin(), state.contacts.end(),
                       [](const Vec3& force) { return force.squaredNorm() > 0; });
  };
  backend_->step(with);
  EXPECT_EQ(pressed(), parameters_.solver == SolverKind::kRod);
  backend_->step(without);
  EXPECT_FALSE(pressed());
}

// Backends make room for what a step needs when the first one does.
TEST_P(Conformance, SettingsThatChangeFindWhatTheyNeed) {
  const StrandModel model = awkwardModel(33, 25);
  const StrandState from = disturbedState(model, 26);
  Parameters plain = parameters_;
  plain.solver = parameters_.solver == SolverKind::kRod ? SolverKind::kGaussSeidel : SolverKind::kRod;
  Parameters all = parameters_;
  all.goal_rate = 5;
  all.damping_time = 0.002f;  // as in the other steps with a goal: a GPU has compiled its programs already
  const auto bodies = movingBodies(all.time_step);
  const StepInput simple{&plain}, rich{&all, {}, {}, bodies};
  const StrandState at_once = stepped(model, from, rich);
  backend_->load(model, from);
  backend_->step(simple);
  backend_->upload(from);
  backend_->step(rich);
  StrandState later;
  backend_->download(later);
  EXPECT_EQ(stateHash(later), stateHash(at_once));
  EXPECT_EQ(later.contacts, at_once.contacts);
}

TEST_P(Conformance, UploadAndDownloadKeepEveryBit) {
  const StrandModel model = awkwardModel(33, 21);
  backend_->load(model, restState(model, model.rest_roots));
  StrandState state = disturbedState(model, 22), back;
  state.velocities[5] = Vec3(-0.0f, 1e-42f, 3e38f);
  backend_->upload(state);
  backend_->download(back);
  EXPECT_EQ(stateHash(back), stateHash(state));
  const std::span<const Vec3> guides = backend_->guides();
  EXPECT_TRUE(std::equal(guides.begin(), guides.end(), state.positions.begin(), state.positions.end()));
}

TEST_P(Conformance, TheSameInputGivesTheSameBits) {
  const StrandModel model = awkwardModel(33, 31);
  const StrandState from = disturbedState(model, 32);
  Parameters parameters = parameters_;
  const std::vector<Pose> bones_end = {movedHead()};
  const auto bodies = movingBodies(parameters.time_step);
  const StepInput input{&parameters, {}, bones_end, bodies};
  const uint64_t first = stateHash(stepped(model, from, input, 3));
  EXPECT_EQ(stateHash(stepped(model, from, input, 3)), first) << "loaded again";
  backend_->upload(from);
  for (int i = 0; i < 3; ++i) backend_->step(input);
  StrandState state;
  backend_->download(state);
  EXPECT_EQ(stateHash(state), first) << "state set again";
  EXPECT_NE(stateHash(from), first);
}

TEST_P(Conformance, StaysFiniteFromDegenerateStates) {
  const StrandModel model = awkwardModel(33, 41);
  const StrandState rest = restState(model, model.rest_roots);
  StrandState coincident = rest, folded = rest;
  for (size_t s = 0; s < model.strands(); ++s) {
    for (uint32_t v = model.offsets[s]; v < model.offsets[s + 1]; ++v) {
      coincident.positions[v] = rest.positions[model.offsets[s]];
      const uint32_t even = model.offsets[s] + (v - model.offsets[s]) % 2;
      folded.positions[v] = rest.positions[even];
    }
  }
  Parameters parameters = parameters_;
  for (const Vec3& gravity : {Vec3(0, -9.81f, 0), Vec3(0, 0, 0)}) {
    parameters.gravity = gravity;
    const auto bodies = movingBodies(parameters.time_step);
    const StepInput input{&parameters, {}, {}, bodies};
    EXPECT_EQ(nonFinite(stepped(model, coincident, input, 10)), 0u) << "coincident, gravity " << gravity.y();
    EXPECT_EQ(nonFinite(stepped(model, folded, input, 10)), 0u) << "folded, gravity " << gravity.y();
    EXPECT_EQ(nonFinite(stepped(model, rest, input, 10)), 0u) << "rest, gravity " << gravity.y();
  }
}

TEST_P(Conformance, ANotANumberStaysInItsStrand) {
  const StrandModel model = awkwardModel(33, 51);
  const StrandState from = disturbedState(model, 52);
  Parameters parameters = parameters_;
  const auto bodies = movingBodies(parameters.time_step);
  const StepInput input{&parameters, {}, {}, bodies};
  const StrandState clean = stepped(model, from, input, 2);
  const size_t ill = 10;  // 31 vertices, free tip
  StrandState poisoned = from;
  poisoned.positions[model.offsets[ill] + 1] = Vec3::Constant(std::numeric_limits<float>::quiet_NaN());
  const StrandState after = stepped(model, poisoned, input, 2);
  EXPECT_GT(nonFinite(after), 0u);
  for (size_t s = 0; s < model.strands(); ++s) {
    if (s == ill) continue;
    for (uint32_t v = model.offsets[s]; v < model.offsets[s + 1]; ++v)
      ASSERT_EQ(after.positions[v], clean.positions[v]) << "strand " << s;
  }
}

TEST_P(Conformance, PinnedVerticesRideOnTheirRoot) {
  const StrandModel model = awkwardModel(33, 61);
  const std::vector<Pose> bones_end = {movedHead()};
  Parameters parameters = parameters_;
  const auto bodies = movingBodies(parameters.time_step);
  const StrandState after = stepped(model, disturbedState(model, 62), {&parameters, {}, bones_end, bodies});
  size_t pinned = 0;
  for (size_t s = 0; s < model.strands(); ++s) {
    for (uint32_t v = model.offsets[s]; v < model.offsets[s + 1]; ++v) {
      if (!model.isPinned(s, v)) continue;
      ++pinned;
      EXPECT_LT((after.positions[v] - bones_end[0].apply(model.restPosition(s, v))).norm(), 1e-6f);
    }
  }
  EXPECT_GT(pinned, model.strands());
}

TEST_P(Conformance, EachRootRidesOnItsOwnOfAsManyBonesAsThereMayBe) {
  constexpr size_t kBones = 65536, kApart = 1900;
  StrandModel model = awkwardModel(33, 65);
  model.bones.resize(kBones, "skin");
  std::vector<Pose> bones_end(kBones);
  for (size_t s = 0; s < model.strands(); ++s) {
    const size_t bone = kBones - 1 - kApart * s;
    model.root_bones.push_back(static_cast<uint16_t>(bone));
    bones_end[bone] = movedBones()[s % 3];
    bones_end[bone].position.y() += 1e-4f * static_cast<float>(s);
  }
  const Parameters parameters = parameters_;
  const StrandState after = stepped(model, disturbedState(model, 66), {&parameters, {}, bones_end});
  for (size_t s = 0; s < model.strands(); ++s)
    for (uint32_t v = model.offsets[s]; v < model.offsets[s + 1]; ++v)
      if (model.isPinned(s, v)) {
        const Vec3 place = bones_end[model.rootBone(s)].apply(model.restPosition(s, v));
        EXPECT_LT((after.positions[v] - place).norm(), 1e-6f) << "strand " << s;
      }
  EXPECT_EQ(nonFinite(after), 0u);
}

TEST_P(Conformance, TiedVerticesGoWithTheirBone) {
  StrandModel model = awkwardModel(33, 63);
  tieToBones(model);
  const std::vector<Pose> bones_end = movedBones();
  ASSERT_EQ(model.bones.size(), 3u);
  const Parameters parameters = parameters_;
  const StrandState after = stepped(model, disturbedState(model, 64), {&parameters, {}, bones_end});
  size_t tied = 0, whole = 0;
  for (size_t s = 0; s < model.strands(); ++s) {
    size_t of_strand = 0;
    for (uint32_t v = model.offsets[s]; v < model.offsets[s + 1]; ++v) {
      if (!model.isBonePinned(s, v)) continue;
      const Vec3 place = bones_end[model.pin_bones[v]].apply(model.restPosition(s, v));
      EXPECT_LT((after.positions[v] - place).norm(), 1e-6f) << "strand " << s;
      ++of_strand;
    }
    tied += of_strand;
    whole += model.rootBone(s) != 0 && model.isPinned(s, model.offsets[s] + 1);
  }
  EXPECT_GT(tied, 10u);
  EXPECT_GT(whole, 3u);
  EXPECT_EQ(nonFinite(after), 0u);
}

// Strands that two pins hold taut, on one bone and on two, also in the middle, thrown about: the bound on
// tensions that are far too high, and the pulls, are as the oracle has them.
TEST_P(Conformance, TautStrandsBetweenPinsAgreeWithTheOracle) {
  if (parameters_.solver != SolverKind::kRod) GTEST_SKIP() << "tensions are the rod's";
  constexpr double kTolerance = 3e-4;  // of the length; measured: 9.2e-5 on CPUs, 1.0e-4 on llvmpipe
  constexpr float kLength = 0.25f, kBend = 0.01f;
  constexpr int kCounts[] = {4, 9, 31, 61, 128};
  StrandSet set;
  for (const int vertices : kCounts)
    for (int s = 0; s < 4; ++s) {
      std::vector<Vec3> points = {Vec3(0.1f, 0, 0.01f * static_cast<float>(s))};
      for (int e = 1; e < vertices; ++e) {
        const float turn =
            kBend * static_cast<float>(s) * (2 * static_cast<float>(e) / static_cast<float>(vertices) - 1);
        points.push_back(points.back() +
                         kLength / static_cast<float>(vertices - 1) * Vec3(1, turn, 0.2f).normalized());
      }
      set.append(points);
      set.pinned.resize(set.vertices(), 0);
      set.pinned.back() = 1;
      if (s == 2) set.pinned[set.vertices() - static_cast<size_t>(vertices / 2)] = 1;
    }
  StrandModel model = makeStrandModel(set);
  model.bones = {"head", "clip"};
  for (size_t s = 1; s < model.strands(); s += 4) pinToBone(model, s, 1, 1, "clip");
  std::vector<Pose> bones_end(2);
  bones_end[0] = bones_end[1] = movedBones()[0];
  bones_end[1].position += Vec3(-1e-5f, 0, 0);
  StrandState from = restState(model, model.rest_roots);
  from.tensions.assign(model.vertices(), 1e7f);
  std::mt19937 random(81);
  std::uniform_real_distribution<float> range(-0.1f, 0.1f);
  for (Vec3& velocity : from.velocities) velocity = Vec3(range(random), range(random), range(random));
  const StepInput input{&parameters_, {}, bones_end};
  const double substep = parameters_.time_step / parameters_.substeps;
  const StrandState mine = stepped(model, from, input), truth = oracleStep(model, from, input);
  const std::vector<double> error = errors(model, mine, truth, substep);
  const std::vector<double> sensitivity = sensitivities(model, from, truth, input, substep);
  double worst = 0;
  for (size_t s = 0; s < model.strands(); ++s) {
    worst = std::max(worst, error[s]);
    EXPECT_LT(error[s], kTolerance + kSensitivityFactor * sensitivity[s]) << "strand " << s;
  }
  std::printf("             at most %.1e of a strand's length\n", worst);
}

// The rod keeps its lengths to rounding. The bounds on the stretch of the other solver are what it keeps on
// 16 vertices with 6 iterations in 4 substeps (mean 0.052, max 0.26 on every backend) with about 40 % to
// spare: few Gauss-Seidel sweeps do not make hair inextensible.
TEST_P(Conformance, InvariantsHoldOver120Steps) {
  StrandSet set;
  std::mt19937 random(71);
  std::uniform_real_distribution<float> range(-1, 1);
  for (int s = 0; s < 61; ++s) {
    const Vec3 out = Vec3(range(random), 0.3f + std::fabs(range(random)), range(random)).normalized();
    std::vector<Vec3> points;
    for (int i = 0; i < 16; ++i) points.push_back(Vec3(0, 1.5f, 0) + out * (0.1f + 0.01f * i));
    set.append(points);
  }
  const StrandModel model = makeStrandModel(set);
  const ContactPrimitive head{PrimitiveKind::kSphere, Vec3(0, 1.5f, 0), Vec3::UnitY(), 0.099f, 0.3f};
  Parameters parameters = parameters_;
  backend_->load(model, restState(model, model.rest_roots));
  std::vector<Pose> begin(1), end(1);
  Measurement worst;
  for (int step = 1; step <= 120; ++step) {
    const float t = static_cast<float>(step) / 60;
    const Quat nod(Eigen::AngleAxisf(0.4f * std::sin(6 * t), Eigen::Vector3f::UnitX()));
    const Vec3 middle(0, 1.5f, 0);
    end[0] = {middle - nod * middle + Vec3(0.05f * std::sin(4 * t), 0, 0), nod};
    const std::vector<MovingPrimitive> bodies = {moved(head, begin[0], end[0], parameters.time_step)};
    backend_->step({&parameters, begin, end, bodies});
    const Measurement now = measure(model, backend_->guides(), bodies);
    worst.mean_stretch = std::max(worst.mean_stretch, now.mean_stretch);
    worst.max_stretch = std::max(worst.max_stretch, now.max_stretch);
    worst.max_penetration = std::max(worst.max_penetration, now.max_penetration);
    worst.non_finite += now.non_finite;
    begin = end;
  }
  std::printf("             stretch mean %.4f max %.4f, penetration %.2e m\n", worst.mean_stretch,
              worst.max_stretch, worst.max_penetration);
  EXPECT_EQ(worst.non_finite, 0u);
  const bool rod = parameters.solver == SolverKind::kRod;
  EXPECT_LT(worst.mean_stretch, rod ? 1e-5 : 0.07);
  EXPECT_LT(worst.max_stretch, rod ? 1e-4 : 0.36);
  EXPECT_LT(worst.max_penetration, 1e-3);
}

// A vertex that is just above a plane, on an edge so short that its length puts it deep below, straight down
// from the root: the nearest point of the plane is no way out.
TEST_P(Conformance, AnEdgeThatGoesStraightInComesOutAllTheWay) {
  if (parameters_.solver != SolverKind::kRod) return;  // the course's scheme lets lengths be what they are
  constexpr float kRoot = 0.004f, kLength = 0.008f;    // m
  StrandSet set;
  set.append(std::vector<Vec3>{Vec3(0, kRoot, 0), Vec3(0, kRoot - kLength, 0)});
  const StrandModel model = makeStrandModel(set);
  StrandState from = restState(model, model.rest_roots);
  from.positions[1].y() = 5e-4f;
  ContactPrimitive plane;
  plane.kind = PrimitiveKind::kPlane;
  const std::vector<MovingPrimitive> bodies{moved(plane, {}, {}, parameters_.time_step)};
  Parameters parameters = parameters_;
  parameters.substeps = 1;
  const StrandState state = stepped(model, from, StepInput{&parameters, {}, {}, bodies});
  EXPECT_NEAR((state.positions[1] - state.positions[0]).norm(), kLength, 1e-6f);
  EXPECT_GT(state.positions[1].y(), 0);
}

// Two planes meet in a crease, and where the root is no place on the edge's length is before both: turning
// the edge out of one wholly takes it 1.1 mm into the other, and the best is 0.3 mm in either.
TEST_P(Conformance, AnEdgeInACreaseIsLeftWhereItIsLeastDeep) {
  if (parameters_.solver != SolverKind::kRod) return;
  const Vec3 root(-0.00318f, -0.0075f, 0), placed(0.00026f, 0.0002f, 0);  // the latter 0.2 mm before both
  constexpr float kLength = 0.00774f;                                     // m, 0.7 mm too short
  StrandSet set;
  set.append(std::vector<Vec3>{root, root + Vec3(0, kLength, 0)});
  StrandModel model = makeStrandModel(set);
  model.rest_distance = {-0.01f, kFarFromBodies};  // the root may be that deep
  StrandState from = restState(model, model.rest_roots);
  from.positions[1] = placed;
  ContactPrimitive plane;
  plane.kind = PrimitiveKind::kPlane;
  ContactPrimitive wall = plane;
  wall.b = Vec3(0.96825f, -0.25f, 0);
  const std::vector<MovingPrimitive> bodies{moved(plane, {}, {}, parameters_.time_step),
                                            moved(wall, {}, {}, parameters_.time_step)};
  Parameters parameters = parameters_;
  parameters.substeps = 1;
  const StrandState state = stepped(model, from, StepInput{&parameters, {}, {}, bodies});
  EXPECT_NEAR((state.positions[1] - state.positions[0]).norm(), kLength, 1e-6f);
  for (const MovingPrimitive& body : bodies) EXPECT_GT(signedDistance(body, state.positions[1], {}), -5e-4f);
}

// A body with a crease comes so that, seen from it, a vertex goes close along its floor into its wall: what
// the vertex grazes does not bound it there.
TEST_P(Conformance, WhatGrazesOneSideOfACreaseIsHeldByTheOther) {
  if (parameters_.solver != SolverKind::kRod) return;
  ContactPrimitive solid;
  solid.kind = PrimitiveKind::kField;
  const Box box(Eigen::Vector3f::Constant(-0.01f), Eigen::Vector3f::Constant(0.01f));
  solid.field = std::make_shared<DistanceField>(
      sampledField([](const Vec3& p) { return std::min(p.x(), p.y()); }, box, 5e-4f, 0.006f));
  ShapeData shapes;
  const uint32_t data = shapes.add(solid);
  const Pose comes{Vec3(0.004f, 0, 0), Quat::Identity()};
  const std::vector<MovingPrimitive> bodies{moved(solid, {}, comes, parameters_.time_step, data)};
  StrandSet set;  // hangs 0.1 mm over the floor, 2 mm before the wall
  set.append(std::vector<Vec3>{Vec3(0.003f, 0.008f, 0), Vec3(0.002f, 1e-4f, 0)});
  StrandModel model = makeStrandModel(set);
  model.rest_distance = {-0.01f, kFarFromBodies};  // the body may cover the root so far
  Parameters parameters = parameters_;
  parameters.substeps = 1;
  parameters.gravity = Vec3::Zero();
  const StepInput input{&parameters, {}, {}, bodies, {}, &shapes};
  const StrandState state = stepped(model, restState(model, model.rest_roots), input);
  EXPECT_GT(signedDistance(bodies[0], state.positions[1], shapes.words), -2e-4f);
}

// Hair on a ball that is a field, with its first vertices in it, while the ball nods and slides and a box is
// pushed through the hair.
TEST_P(Conformance, FieldsAndBoxesHoldHairOutOver60Steps) {
  StrandSet set;
  std::mt19937 random(75);
  std::uniform_real_distribution<float> range(-1, 1);
  for (int s = 0; s < 61; ++s) {
    const Vec3 out = Vec3(range(random), 0.3f + std::fabs(range(random)), range(random)).normalized();
    std::vector<Vec3> points;
    for (int i = 0; i < 16; ++i) points.push_back(out * (0.085f + 0.01f * i));
    set.append(points);
  }
  ContactPrimitive ball;
  ball.kind = PrimitiveKind::kField;
  const Box box(Eigen::Vector3f::Constant(-0.1f), Eigen::Vector3f::Constant(0.1f));
  ball.field = std::make_shared<DistanceField>(
      sampledField([](const Vec3& p) { return p.norm() - 0.1f; }, box, 0.005f, 0.02f));
  RigidBody head{{ball}, true, true};
  Simulation simulation(makeStrandModel(set), {head}, parameters_, GetParam().create());
  ContactPrimitive slab;
  slab.kind = PrimitiveKind::kBox;
  slab.extent = Vec3(0.05f, 0.01f, 0.05f);
  const BodyId pushed = simulation.addBody({{slab}, false, false, {Vec3(0, 0.4f, 0), Quat::Identity()}});
  Measurement worst;
  size_t in_ball = 0;
  for (const float distance : simulation.model().rest_distance) in_ball += distance < 0;
  for (int step = 1; step <= 60; ++step) {
    const float t = static_cast<float>(step) / 60;
    const Quat nod(Eigen::AngleAxisf(0.3f * std::sin(6 * t), Eigen::Vector3f::UnitX()));
    simulation.setHeadPose({Vec3(0.05f * std::sin(4 * t), 0, 0), nod});
    simulation.setBodyPose(pushed, {Vec3(0, 0.4f - 0.2f * t, 0), nod});
    simulation.step();
    const Measurement now = simulation.measure();
    worst.max_penetration = std::max(worst.max_penetration, now.max_penetration);
    worst.non_finite += now.non_finite;
  }
  std::printf("             penetration %.2e m\n", worst.max_penetration);
  EXPECT_EQ(worst.non_finite, 0u);
  EXPECT_EQ(in_ball, 2u * 61u);
  // Hair that keeps its length must buckle before it makes way for a box that comes at its tip (1.0 mm on
  // every backend).
  EXPECT_LT(worst.max_penetration, parameters_.solver == SolverKind::kRod ? 2e-3 : 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Backends, Conformance, testing::ValuesIn(contestants()),
                         [](const auto& contestant) { return contestant.param.name; });

}  // namespace
}  // namespace strandcast
