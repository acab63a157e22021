#include "gpu_compute/gpu_air.h"

#include <gtest/gtest.h>

#include <cmath>

#include "air/air_system.h"
#include "core/error.h"
#include "core/simulation.h"
#include "gpu_compute/gpu_backend.h"
#include "validation/specimen.h"

namespace strandcast {
namespace {

constexpr double kStep = 1.0 / 60;
constexpr int kCells = 16;

class GpuAir : public testing::Test {
 protected:
  void SetUp() override {
    if (!gpuBackendInfo().available) GTEST_SKIP() << gpuBackendInfo().reason;
    if (!gpu_) gpu_ = makeGpuBackend();
  }
  static void TearDownTestSuite() { gpu_.reset(); }

  static inline std::unique_ptr<Backend> gpu_;  // shared by all tests: its shaders take long to compile
};

// A wind after a step and one more advection, with everything that moves air except hair.
std::unique_ptr<Wind> blown(const AirFactory& maker, bool mac_cormack, Wind::Border border) {
  std::unique_ptr<Wind> wind = maker.wind(kCells, 0.05f, border);
  Parameters parameters;
  parameters.wind = Vec3(3, 0.5f, -1);
  parameters.turbulence = 0.3f;
  parameters.gust = 0.2f;
  wind->ambient().configure(parameters);
  wind->ambient().advance(0.7);
  wind->centreAt(Vec3(0.2f, 1.6f, -0.1f));
  wind->reset();
  if (border == Wind::Border::kClosed)
    wind->setVelocity([](const Vec3& x) { return Vec3(std::sin(4 * x.y()), std::cos(3 * x.z()), x.x()); });
  ContactPrimitive ball;
  ball.a = Vec3(0.22f, 1.58f, -0.1f);
  ball.radius = 0.13f;
  const Pose end{Vec3(0.004f, 0, 0.002f), Quat(Eigen::AngleAxisf(0.02f, Eigen::Vector3f::UnitY()))};
  const MovingPrimitive body = moved(ball, Pose{}, end, static_cast<float>(kStep));
  wind->clearSolids();
  wind->addSolids({&body, 1}, {}, kStep);
  wind->advect(kStep, mac_cormack);
  wind->diffuse(kStep, 0.01);
  wind->project();
  wind->centreAt(Vec3(0.31f, 1.6f, -0.1f));
  wind->advect(kStep, mac_cormack);
  return wind;
}

TEST_F(GpuAir, WindIsThatOfTheReference) {
  for (const Wind::Border border : {Wind::Border::kOpen, Wind::Border::kClosed}) {
    const bool mac_cormack = border == Wind::Border::kOpen;
    const std::unique_ptr<Wind> truth = blown(cpuAir("reference"), mac_cormack, border),
                                wind = blown(gpuAir(), mac_cormack, border);
    ASSERT_EQ(wind->origin(), truth->origin());
    double largest = 0, changed = 0;
    for (int axis = 0; axis < 3; ++axis)
      for (int k = 0; k < kCells; ++k)
        for (int j = 0; j < kCells; ++j)
          for (int i = 0; i < kCells; ++i) {
            const double t = truth->component(axis, i, j, k);
            largest = std::max(largest, std::fabs(wind->component(axis, i, j, k) - t));
            changed = std::max(changed, std::fabs(t - 3 * (axis == 0)));
          }
    EXPECT_LT(largest, 2e-4) << "m/s";
    EXPECT_GT(changed, 1);
    EXPECT_LT(
        (wind->velocityAt(Vec3(0.3f, 1.61f, -0.2f)) - truth->velocityAt(Vec3(0.3f, 1.61f, -0.2f))).norm(),
        2e-4f);
    EXPECT_NEAR(wind->fastest(), truth->fastest(), 2e-4);
  }
}

// Three moving spheres: one in still air, a small one that draws air in, and one half inside a ball. Then
// none.
TEST_F(GpuAir, SpheresOfWindBlowAsOnTheReference) {
  WindSource large;
  large.kind = WindSource::Kind::kSphere;
  large.position = Vec3(-0.11f, 0.02f, 0.013f);
  large.radius = 0.1f;
  WindSource small = large, touching = large;
  small.position = Vec3(0.1f, -0.24f, 0.2f);
  small.radius = 0.01f;
  small.speed = -60;
  touching.position = Vec3(0.2f, 0.16f, 0);
  for (const Wind::Border border : {Wind::Border::kOpen, Wind::Border::kClosed}) {
    const std::unique_ptr<Wind> truth = cpuAir("reference").wind(kCells, 0.05f, border),
                                wind = gpuAir().wind(kCells, 0.05f, border);
    ContactPrimitive ball;
    ball.a = touching.position + Vec3(0.06f, 0, 0);
    ball.radius = 0.1f;
    const MovingPrimitive body = moved(ball, Pose{}, Pose{}, static_cast<float>(kStep));
    std::vector<WindSource> sources{large, small, touching};
    const auto step = [&] {
      for (Wind* one : {truth.get(), wind.get()}) {
        one->clearSolids();
        one->addSolids({&body, 1}, {}, kStep);
        one->setSources(sources);
        one->advect(kStep, false);
        one->exchange(kStep);
        one->project();
      }
    };
    const auto off = [&] {
      double largest = 0;
      for (int axis = 0; axis < 3; ++axis)
        for (int k = 0; k < kCells; ++k)
          for (int j = 0; j < kCells; ++j)
            for (int i = 0; i < kCells; ++i)
              largest = std::max(largest,
                                 std::fabs(wind->component(axis, i, j, k) - truth->component(axis, i, j, k)));
      return largest;
    };
    for (Wind* one : {truth.get(), wind.get()}) one->centreAt(Vec3::Zero());
    for (int n = 0; n < 3; ++n) {
      step();
      EXPECT_LT(off(), 2e-3) << "m/s";
      for (WindSource& source : sources) source.position += Vec3(0.01f, 0.02f, 0);
    }
    if (border == Wind::Border::kOpen) {
      EXPECT_GT(truth->fastest(), 2);
      EXPECT_LT(truth->largestOutflow(), 1e-3 * truth->fastest());
      EXPECT_LT(wind->largestOutflow(), 1e-3 * wind->fastest());
    } else {
      EXPECT_EQ(wind->fastest(), 0);
    }
    sources.clear();
    step();
    EXPECT_LT(off(), 2e-3) << "m/s";
    EXPECT_LT(wind->largestOutflow(), 1e-3 * wind->fastest() + 1e-6) << "they are off";
  }
}

// A compressed tuft of tapered hair. Strands differ in vertex count; some edges are longer than a cell.
struct Tuft {
  StrandModel model;
  StrandState state;

  Tuft() {
    std::vector<StrandPoints> strands;
    for (int s = 0; s < 120; ++s) {
      StrandPoints points = straightStrand(0.2, s % 5 == 0 ? 3 : 12 + s % 7, -Vec3::UnitY());
      const Vec3 root(0.004f * static_cast<float>(s % 13), 0.001f * static_cast<float>(s % 3),
                      0.004f * static_cast<float>(s / 13));
      for (Vec3& p : points) p += root;
      strands.push_back(points);
    }
    Material tapered;
    tapered.radius_scale.knots = {{0.0f, 1.0f}, {1.0f, 0.3f}};
    model = modelOf(strands, tapered);
    state = restState(model, model.rest_roots);
    for (size_t v = 0; v < model.vertices(); ++v) {
      const auto n = static_cast<float>(v);
      state.positions[v].x() *= 0.6f;
      state.velocities[v] = Vec3(std::sin(1.3f * n), std::cos(2.9f * n), 1 + std::sin(n));
    }
  }
};

Parameters everything() {
  Parameters parameters;
  parameters.grid_cells = kCells;
  parameters.solver = SolverKind::kRod;
  parameters.wind = Vec3(3, 0, 1);
  parameters.wind_grid = 1;
  parameters.turbulence = 0.2f;
  parameters.air_drag = 4;
  parameters.air_drag_along = 0.5f;
  parameters.volume_stiffness = 1;
  parameters.hair_friction = 5;
  return parameters;
}

struct Felt {
  std::vector<Vec3> accelerations;
  AirSample beside;  ///< in the lee of the hair
};
/// Accelerations and air after `steps` steps of the air system alone; the strands are not stepped.
Felt felt(const AirFactory& maker, Backend& backend, const Tuft& tuft, const Parameters& parameters,
          std::vector<WindSource> sources = {}, int steps = 2) {
  const std::unique_ptr<ExternalForces> air_system = maker.make(std::move(sources));
  backend.load(tuft.model, tuft.state);
  air_system->configure(tuft.model, parameters, backend);
  const std::vector<Pose> bones{
      {Vec3(0.003f, 0, 0), Quat(Eigen::AngleAxisf(0.3f, Eigen::Vector3f::UnitX()))}};
  for (int step = 0; step < steps; ++step) {
    StepInput input;
    input.parameters = &parameters;
    input.bones_begin = input.bones_end = bones;
    air_system->step(input, backend);
  }
  const std::span<const Vec3> out = air_system->accelerations();
  Felt felt{{out.begin(), out.end()}, {}};
  const AirFields* fields = airSystem(air_system.get());
  if (fields->hasWind()) felt.beside = fields->at(Vec3(0.08f, -0.1f, 0.06f));
  return felt;
}

void expectSame(const Felt& got, const Felt& truth) {
  double largest = 0, off = 0;
  for (size_t v = 0; v < truth.accelerations.size(); ++v) {
    largest = std::max(largest, double{truth.accelerations[v].norm()});
    off = std::max(off, double{(got.accelerations[v] - truth.accelerations[v]).norm()});
  }
  EXPECT_GT(largest, 1);
  EXPECT_LT(off, 2e-3 * largest);
}

TEST_F(GpuAir, StrandsFeelWhatTheyFeelOnTheReference) {
  const Tuft tuft;
  const std::unique_ptr<Backend> reference = makeReferenceBackend();
  WindSource fan;
  fan.position = Vec3(0, -0.1f, -0.1f);
  fan.speed = 4;
  WindSource turbine = fan;
  turbine.kind = WindSource::Kind::kTurbine;
  turbine.swirl = 2;
  {
    SCOPED_TRACE("grids");
    WindSource thin = turbine;
    thin.length = 1e-3f;
    const Felt got = felt(gpuAir(), *gpu_, tuft, everything(), {fan, turbine, thin}),
               truth = felt(cpuAir("reference"), *reference, tuft, everything(), {fan, turbine, thin});
    expectSame(got, truth);
    EXPECT_LT((got.beside.wind - truth.beside.wind).norm(), 1e-3f);
    EXPECT_NEAR(got.beside.density, truth.beside.density, 1e-3f * std::fabs(truth.beside.density) + 1e-6f);
    EXPECT_NEAR(got.beside.pressure, truth.beside.pressure, 0.02f);
  }
  {
    SCOPED_TRACE("a sphere of wind in hair, and one beside it");
    WindSource within = fan, beside = fan;
    within.kind = beside.kind = WindSource::Kind::kSphere;
    within.radius = 0.03f;
    beside.position = Vec3(0.12f, -0.05f, 0.05f);
    beside.speed = -3;
    const Felt got = felt(gpuAir(), *gpu_, tuft, everything(), {within, turbine, beside}, 4),
               truth =
                   felt(cpuAir("reference"), *reference, tuft, everything(), {within, turbine, beside}, 4),
               without = felt(cpuAir("reference"), *reference, tuft, everything(), {turbine}, 4);
    expectSame(got, truth);
    EXPECT_LT((got.beside.wind - truth.beside.wind).norm(), 3e-3f);
    EXPECT_GT((without.beside.wind - truth.beside.wind).norm(), 0.3f);
  }
  {
    SCOPED_TRACE("air that slips along hair");
    Parameters parameters = everything();
    parameters.hairs_per_strand = 1000;
    parameters.air_drag_along = 0.1f;
    parameters.air_viscosity = 0.01f;
    const Felt got = felt(gpuAir(), *gpu_, tuft, parameters, {fan}, 4),
               truth = felt(cpuAir("reference"), *reference, tuft, parameters, {fan}, 4);
    expectSame(got, truth);
    EXPECT_LT((got.beside.wind - truth.beside.wind).norm(), 2e-3f);
    parameters.air_drag_along = 1;
    const Felt alike = felt(cpuAir("reference"), *reference, tuft, parameters, {fan}, 4);
    EXPECT_GT((alike.beside.wind - truth.beside.wind).norm(), 0.02f);
  }
  Tuft own = tuft;
  own.model.air_drag_scale.assign(own.model.vertices(), 1);
  for (size_t v = 0; v < own.model.vertices(); v += 2) own.model.air_drag_scale[v] = 0.5f;
  {
    SCOPED_TRACE("drags of their own");
    Tuft half = own;
    for (size_t v = 0; v < half.model.vertices() / 2; ++v) half.model.air_drag_scale[v] = 0;
    Parameters parameters = everything();
    parameters.hairs_per_strand = 1000;
    const Felt got = felt(gpuAir(), *gpu_, half, parameters),
               truth = felt(cpuAir("reference"), *reference, half, parameters);
    expectSame(got, truth);
    EXPECT_LT((got.beside.wind - truth.beside.wind).norm(), 1e-3f);
  }
  {
    SCOPED_TRACE("no wind grid, drags of their own");
    Parameters parameters = everything();
    parameters.wind_grid = 0;
    expectSame(felt(gpuAir(), *gpu_, own, parameters, {fan}),
               felt(cpuAir("reference"), *reference, own, parameters, {fan}));
  }
  {
    SCOPED_TRACE("more pieces of a strand than one workgroup takes");
    Parameters parameters = everything();
    parameters.wind_grid = 0;
    parameters.grid_cells = 128;
    expectSame(felt(gpuAir(), *gpu_, tuft, parameters),
               felt(cpuAir("reference"), *reference, tuft, parameters));
  }
}

// setSources() replaces all earlier sources: those of configure() and those of earlier calls.
TEST_F(GpuAir, TakesOtherSourcesBetweenSteps) {
  const Tuft tuft;
  for (const int grid : {0, 1}) {
    SCOPED_TRACE(grid);
    Parameters parameters = everything();
    parameters.wind_grid = grid;
    WindSource fan;
    fan.position = Vec3(0, -0.1f, -0.1f);
    fan.speed = 4;
    WindSource other = fan;
    other.speed = -9;
    WindSource ball = fan;
    ball.kind = WindSource::Kind::kSphere;
    const std::vector<WindSource> one{fan, ball}, others{other, ball, other, ball};
    const auto twoSteps = [&](const std::vector<WindSource>& made, const std::vector<WindSource>& told) {
      const std::unique_ptr<ExternalForces> air_system = gpuAir().make(made);
      gpu_->load(tuft.model, tuft.state);
      air_system->configure(tuft.model, parameters, *gpu_);
      StepInput input;
      input.parameters = &parameters;
      for (int step = 0; step < 2; ++step) {
        airSystem(air_system.get())->setSources(made);
        airSystem(air_system.get())->setSources(told);
        air_system->step(input, *gpu_);
      }
      const std::span<const Vec3> out = air_system->accelerations();
      return std::vector<Vec3>(out.begin(), out.end());
    };
    const std::vector<Vec3> none = twoSteps({}, {}), blown = twoSteps(one, one);
    EXPECT_NE(blown, none);
    EXPECT_NE(twoSteps(others, others), blown);
    EXPECT_EQ(twoSteps(others, one), blown);
    EXPECT_EQ(twoSteps({}, one), blown);
    EXPECT_EQ(twoSteps(others, {}), none);
  }
}

// projectAhead() solves with one iteration more than the step before last took, which is few for a new
// source.
TEST_F(GpuAir, ASphereThatIsSwitchedOnWhileOthersRunSoonBlows) {
  const Tuft tuft;
  Parameters parameters = everything();
  parameters.wind = Vec3::Zero();
  parameters.hairs_per_strand = 0;
  WindSource ball;
  ball.kind = WindSource::Kind::kSphere;
  ball.position = Vec3(0.1f, 0, 0);
  ball.radius = 0.05f;
  const auto blown = [&](const AirFactory& maker, Backend& backend) {
    const std::unique_ptr<ExternalForces> air_system = maker.make({});
    backend.load(tuft.model, tuft.state);
    air_system->configure(tuft.model, parameters, backend);
    StepInput input;
    input.parameters = &parameters;
    for (int step = 0; step < 14; ++step) {
      if (step == 8) airSystem(air_system.get())->setSources({ball});
      air_system->step(input, backend);
    }
    return airSystem(air_system.get())->at(ball.position + Vec3(0.07f, 0, 0)).wind;
  };
  const std::unique_ptr<Backend> reference = makeReferenceBackend();
  const Vec3 truth = blown(cpuAir("reference"), *reference);
  EXPECT_GT(truth.x(), 1);
  EXPECT_LT((blown(gpuAir(), *gpu_) - truth).norm(), 0.02f * truth.norm());
}

TEST_F(GpuAir, EveryRunGivesTheSameBitsAndHairAtRestFeelsNothing) {
  Tuft tuft;
  Parameters parameters = everything();
  const Felt first = felt(gpuAir(), *gpu_, tuft, parameters);
  EXPECT_EQ(felt(gpuAir(), *gpu_, tuft, parameters).accelerations, first.accelerations);
  tuft.state = restState(tuft.model, tuft.model.rest_roots);
  parameters.hair_friction = 0;
  parameters.wind_grid = 0;
  parameters.turbulence = 0;
  parameters.air_drag_along = 1;
  const std::unique_ptr<ExternalForces> air_system = gpuAir().make({});
  gpu_->load(tuft.model, tuft.state);
  air_system->configure(tuft.model, parameters, *gpu_);
  StepInput input;
  input.parameters = &parameters;
  air_system->step(input, *gpu_);
  for (const Vec3& acceleration : air_system->accelerations()) EXPECT_EQ(acceleration, Vec3(Vec3::Zero()));
}

// Uses the PBD solver, whose shaders compile faster; both solvers read accelerations in the same way.
TEST_F(GpuAir, AStepHeedsWhatSurroundingsLeaveOnTheGpuAlsoFarFromTheOrigin) {
  const Tuft tuft;
  Parameters parameters = everything();
  parameters.solver = SolverKind::kGaussSeidel;
  struct Run {
    std::vector<Vec3> positions;
    Vec3 wind;
  };
  // Results are relative to `at`, the position of the whole scene.
  auto run = [&](std::unique_ptr<Backend> backend, const AirFactory& maker, const Vec3& at) {
    WindSource fan;
    fan.position = at + Vec3(0, -0.1f, -0.1f);
    fan.speed = 4;
    Simulation simulation(tuft.model, {}, parameters, std::move(backend), maker.make({fan}));
    simulation.teleport({at, Quat::Identity()});
    for (int step = 0; step < 5; ++step) simulation.step();
    Run out;
    for (const Vec3& position : simulation.guides()) out.positions.push_back(position - at);
    const AirFields* const fields = airSystem(simulation.externalForces());
    EXPECT_TRUE(fields->box().contains(Eigen::Vector3f(at)));
    out.wind = fields->at(at + Vec3(0, -0.1f, 0)).wind;
    return out;
  };
  const Run near = run(makeReferenceBackend(), cpuAir("reference"), Vec3::Zero()),
            far = run(std::move(gpu_), gpuAir(), Vec3(512, 0, -256));
  EXPECT_GT(near.wind.norm(), 0.1f);
  EXPECT_LT((far.wind - near.wind).norm(), 1e-3f);
  const std::vector<Vec3>&truth = near.positions, &got = far.positions;
  double off = 0, way = 0;
  for (size_t v = 0; v < truth.size(); ++v) {
    off = std::max(off, double{(got[v] - truth[v]).norm()});
    way = std::max(way, double{(truth[v] - tuft.state.positions[v]).norm()});
  }
  EXPECT_GT(way, 1e-3);
  EXPECT_LT(off, 2e-2 * way);
}

// Two heads walk past a fan. The first simulation rebases its origin to follow the head; the second does not.
TEST_F(GpuAir, AirStaysInItsPlaceWhenTheOriginFollowsTheHead) {
  const Tuft tuft;
  const Vec3 start(3.75f, 0, 0), pace(0.1875f, 0, 0.0625f);  // m; m per step
  for (const int grid : {0, 1}) {
    SCOPED_TRACE(grid);
    Parameters parameters = everything();
    parameters.solver = SolverKind::kGaussSeidel;
    parameters.wind_grid = grid;
    WindSource fan;
    fan.kind = WindSource::Kind::kTurbine;
    fan.position = start + 23 * pace;
    fan.radius = fan.length = 1;
    const auto walker = [&] {
      return Simulation(tuft.model, {}, parameters, makeGpuBackend(), gpuAir().make({fan}));
    };
    Simulation follows = walker(), stays = walker();
    for (Simulation* simulation : {&follows, &stays}) simulation->teleport({start, Quat::Identity()});
    double off = 0, wind_off = 0, density_off = 0, max_density = 0;
    for (int step = 1; step < 28; ++step) {
      for (Simulation* simulation : {&follows, &stays}) {
        simulation->setHeadPose({start + static_cast<float>(step) * pace, Quat::Identity()});
        simulation->step();
      }
      EXPECT_EQ(follows.resetDiverged(), 0u);
      const std::span<const Vec3> at = follows.guides(), truth = stays.guides();
      for (size_t v = 0; v < at.size(); ++v) off = std::max<double>(off, (at[v] - truth[v]).norm());
      if (follows.origin().isZero()) continue;
      const Vec3 in_hair =
          truth[tuft.model.offsets[61] + 3] - 0.5f * pace;  // where the grids have it: half a step ago
      const AirSample seen = airSystem(follows.externalForces())->at(in_hair),
                      known = airSystem(stays.externalForces())->at(in_hair);
      wind_off = std::max<double>(wind_off, (seen.wind - known.wind).norm());
      density_off = std::max<double>(density_off, std::fabs(seen.density - known.density));
      max_density = std::max<double>(max_density, known.density);
    }
    EXPECT_GT(max_density, 0.04) << "kg/m^3, after the origin moved";
    EXPECT_LT(off, 2e-4) << "m";
    EXPECT_LT(wind_off, 5e-3) << "m/s";
    EXPECT_LT(density_off, 1e-3) << "kg/m^3";
  }
}

TEST_F(GpuAir, AfterAResetAndWhereItWasSwitchedOffItIsAsAtTheStart) {
  const Tuft tuft;
  Parameters windy = everything();
  windy.solver = SolverKind::kGaussSeidel;
  windy.gust = 0.5f;
  Simulation simulation(tuft.model, {}, windy, std::move(gpu_), gpuAir().make({}));
  const auto wind = [&] { return airSystem(simulation.externalForces())->at(Vec3(0, -0.1f, 0.1f)).wind; };
  Vec3 winds[2];
  for (Vec3& seen : winds) {
    simulation.reset();
    for (int step = 0; step < 20; ++step) simulation.step();
    seen = wind();
  }
  EXPECT_GT(winds[0].norm(), 0.5f);
  EXPECT_LT((winds[1] - winds[0]).norm(), 1e-2f);
  Parameters calm = windy;
  calm.wind = Vec3::Zero();
  calm.wind_grid = 0;
  simulation.setParameters(calm);
  simulation.step();
  calm.wind_grid = 1;
  simulation.setParameters(calm);
  simulation.step();
  EXPECT_LT(wind().norm(), 0.1f);
}

// configure() between steps replaces the grids: queries must not use downloaded data of the old ones.
TEST_F(GpuAir, WhatIsSeenIsOfTheGridsThatThereAre) {
  const Tuft tuft;
  if (!gpu_) gpu_ = makeGpuBackend();
  gpu_->load(tuft.model, tuft.state);
  const std::unique_ptr<ExternalForces> air_system = gpuAir().make({});
  const AirFields& fields = *airSystem(air_system.get());
  Parameters parameters = everything();
  parameters.turbulence = 0;
  air_system->configure(tuft.model, parameters, *gpu_);
  StepInput input;
  input.parameters = &parameters;
  air_system->step(input, *gpu_);
  const float old_cell = fields.cell();
  EXPECT_GT(fields.at(fields.box().center()).wind.norm(), 0);
  parameters.grid_cells *= 2;
  air_system->configure(tuft.model, parameters, *gpu_);
  EXPECT_LT(fields.cell(), old_cell);
  for (const float place : {0.1f, 0.5f, 0.9f}) {
    const AirSample seen = fields.at(fields.box().min() + place * fields.box().sizes());
    EXPECT_LT((seen.wind - parameters.wind).norm(), 1e-3f) << place;
    EXPECT_FALSE(seen.solid);
  }
}

TEST_F(GpuAir, NeedsTheStrandsOnTheSameGpu) {
  const Tuft tuft;
  const std::unique_ptr<Backend> reference = makeReferenceBackend();
  reference->load(tuft.model, tuft.state);
  EXPECT_THROW(gpuAir().make({})->configure(tuft.model, everything(), *reference), Error);
}

}  // namespace
}  // namespace strandcast
