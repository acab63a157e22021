#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <unordered_map>

#include "air/hair_grid.h"
#include "validation/experiments.h"
#include "validation/specimen.h"

namespace strandcast {
namespace {

constexpr double kFrameRate = 60;                 // 1/s
constexpr float kStiffness = 40, kFriction = 10;  // m^2/s^2, 1/s

Parameters parametersOf(const Laboratory& laboratory, float stiffness, float friction, float air_drag) {
  Parameters parameters = laboratory.parameters(kFrameRate, air_drag);
  parameters.substeps = 4;
  parameters.damping_time = 5e-4f;
  parameters.volume_stiffness = stiffness;
  parameters.hair_friction = friction;
  return parameters;
}

// Volume of hair: the sum over vertices of mass over local density, by cubes of 1 cm fixed in the world.
// Independent of the grid under test.
double volumeOf(std::span<const Vec3> positions) {
  constexpr double kCube = 0.01;
  auto key = [](int x, int y, int z) { return (static_cast<int64_t>(x) * 4096 + y) * 4096 + z; };
  std::unordered_map<int64_t, double> cubes;
  auto eachCorner = [&](const Vec3& p, const auto& body) {
    const Eigen::Vector3d at = p.cast<double>() / kCube;
    const Eigen::Vector3d low = at.array().floor(), part = at - low;
    for (int c = 0; c < 8; ++c) {
      double weight = 1;
      for (int axis = 0; axis < 3; ++axis) weight *= (c >> axis & 1) != 0 ? part[axis] : 1 - part[axis];
      body(key(static_cast<int>(low.x()) + (c & 1), static_cast<int>(low.y()) + (c >> 1 & 1),
               static_cast<int>(low.z()) + (c >> 2)),
           weight);
    }
  };
  for (const Vec3& p : positions) eachCorner(p, [&](int64_t cube, double weight) { cubes[cube] += weight; });
  double volume = 0;
  for (const Vec3& p : positions) {
    double density = 0;
    eachCorner(p, [&](int64_t cube, double weight) { density += weight * cubes[cube]; });
    volume += std::pow(kCube, 3) / density;
  }
  return volume;
}

constexpr double kHeadRates[] = {60, 240};  // steps per second; shorter steps allow more stiffness

std::vector<std::string> namesOfFullHead() {
  std::vector<std::string> names;
  for (const char* pattern :
       {"full head rate={:g}", "full head rate={:g}: falls in", "full head rate={:g}: speed"})
    for (const std::string& name : caseNames(pattern, kHeadRates)) names.push_back(name);
  return names;
}

std::vector<Case> fullHead(const Laboratory& laboratory) {
  std::vector<Case> volumes, losses, speeds;
  for (const double rate : kHeadRates) {
    double kept[2] = {}, speed = 0;
    for (const bool on : {false, true}) {
      Parameters parameters = parametersOf(laboratory, on ? kStiffness : 0, kFriction, 2);
      parameters.time_step = static_cast<float>(1 / rate);
      parameters.substeps = static_cast<int>(240 / rate);
      Simulation simulation = laboratory.simulation(headOfHair(1000, 0.2, 23, 2), {headBody()}, parameters);
      const double rest = volumeOf(simulation.guides());
      laboratory.advance(simulation, 5);
      kept[on ? 1 : 0] = 100 * volumeOf(simulation.guides()) / rest;
      speed = 1e3 * rmsSpeedOf(simulation.state().velocities);
    }
    const std::string name = fmt::format("full head rate={:g}", rate);
    volumes.push_back(atLeastCase({name, "volume after 5 s, % of that at rest", "%"}, kept[1], 100, 5));
    losses.push_back(atLeastCase(
        {name + ": falls in", "volume lost in 5 s with volume_stiffness off, % of that at rest", "%"},
        100 - kept[0], 50, 0));
    speeds.push_back(
        absoluteCase({name + ": speed", "rms speed of all vertices after 5 s", "mm/s"}, speed, 0, 10));
  }
  volumes.insert(volumes.end(), losses.begin(), losses.end());
  volumes.insert(volumes.end(), speeds.begin(), speeds.end());
  return volumes;
}

// Hair at rest gets no force; its residual motion is rounding in its own elasticity.
std::vector<Case> atRest(const Laboratory& laboratory) {
  const StrandModel model = headOfHair(600, 0.2, 23, 2);
  double ways[2] = {}, felt = 0;
  for (const bool on : {false, true}) {
    Parameters parameters = parametersOf(laboratory, on ? kStiffness : 0, 0, 1);
    parameters.gravity.setZero();
    Simulation simulation = laboratory.simulation(model, parameters);
    const StrandState before = simulation.state();
    if (on)
      for (const Vec3& acceleration : laboratory.accelerations(model, before, parameters))
        felt = worse(felt, static_cast<double>(acceleration.norm()));
    laboratory.advance(simulation, 1);
    const std::span<const Vec3> now = simulation.guides();
    double squares = 0;
    for (size_t v = 0; v < now.size(); ++v)
      squares += (now[v] - before.positions[v]).cast<double>().squaredNorm();
    ways[on ? 1 : 0] = std::sqrt(squares / static_cast<double>(now.size()));
  }
  Case way = absoluteCase({"groom at rest: way", "rms of a vertex after 1 s", "m"}, ways[1], 0, 1e-6);
  way.note = fmt::format("without forces between hairs {:.2g} m", ways[0]);
  return {way,
          absoluteCase({"groom at rest: push", "largest acceleration of a vertex", "m/s^2"}, felt, 0, 1e-6)};
}

// A squeezed head of hair with a random velocity per strand: the sum of all impulses of a step.
std::vector<Case> momentum(const Laboratory& laboratory) {
  const StrandModel model = headOfHair(1000, 0.2, 23, 2);
  std::vector<Case> cases;
  for (const bool pushes : {true, false}) {
    StrandState state;
    for (size_t s = 0; s < model.strands(); ++s)
      for (uint32_t v = model.offsets[s]; v < model.offsets[s + 1]; ++v) {
        state.positions.emplace_back(model.restPosition(s, v) * 0.8f);
        const auto n = static_cast<float>(s);
        state.velocities.emplace_back(std::sin(1.7f * n), 0.5f + std::sin(2.3f * n + 1), std::cos(3.1f * n));
      }
    const std::vector<Vec3> accelerations = laboratory.accelerations(
        model, state, parametersOf(laboratory, pushes ? kStiffness : 0, pushes ? 0 : kFriction, 1));
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double all = 0;
    for (size_t s = 0; s < model.strands(); ++s)
      for (uint32_t v = model.offsets[s]; v < model.offsets[s + 1]; ++v) {
        const Eigen::Vector3d force = static_cast<double>(model.mass[v]) *
                                      static_cast<double>(model.reference_mass[s]) *
                                      accelerations[v].cast<double>();
        sum += force;
        all += force.norm();
      }
    cases.push_back(absoluteCase({pushes ? "momentum of pushes" : "momentum of friction",
                                  "sum of impulses over the sum of their sizes", ""},
                                 all > 0 ? sum.norm() / all : std::nan(""), 0, 1e-4));
  }
  return cases;
}

// Two wisps that are apart at rest; then the roots of one are moved into the other.
StrandModel wisps(double apart) {
  constexpr int kSide = 10, kHairEdges = 24;
  constexpr double kLength = 0.2, kBetween = 0.004;
  Material limp;
  limp.youngs_modulus = 1e7f;
  std::vector<StrandPoints> strands;
  for (int wisp = 0; wisp < 2; ++wisp)
    for (int x = 0; x < kSide; ++x)
      for (int z = 0; z < kSide; ++z) {
        StrandPoints points = straightStrand(kLength, kHairEdges, -Vec3::UnitY());
        const Vec3 root(static_cast<float>(wisp * apart + x * kBetween), 0, static_cast<float>(z * kBetween));
        for (Vec3& p : points) p += root;
        strands.push_back(points);
      }
  StrandModel model = modelOf(strands, limp);
  for (size_t s = kSide * kSide; s < 2 * kSide * kSide; ++s) pinToBone(model, s, 0, 0, "other");
  return model;
}

struct WispState {
  double density = 0;  ///< density of outer halves over that at rest; roots are fixed
  double speed = 0;    ///< mm/s, largest rms speed in the last half second
};
WispState carriedTogether(const Laboratory& laboratory, float stiffness) {
  constexpr double kApart = 0.082, kCarried = 0.08, kCarrying = 0.5, kSeconds = 6, kWatched = 0.5;
  const Parameters parameters = parametersOf(laboratory, stiffness, kFriction, 5);
  const StrandModel model = wisps(kApart);
  Simulation simulation = laboratory.simulation(model, parameters);
  const Workers workers(1);
  HairGrid<float> grid(scalarPasses<float>(), workers, model, parameters.grid_cells, restBox(model));
  auto density = [&] {
    const StrandState now = simulation.state();
    grid.locate(now.positions, now.velocities, Pose{});
    grid.splat();
    grid.computeForces(parameters, parameters.time_step);
    double sum = 0, count = 0;
    for (size_t s = 0; s < model.strands(); ++s) {
      const uint32_t first = grid.samples().offsets[s], end = grid.samples().offsets[s + 1];
      for (uint32_t n = (first + end) / 2; n < end; ++n, ++count) {
        auto node = [&](int axis) { return static_cast<int>(std::lround(grid.places(axis)[n])); };
        sum += grid.densityAt(node(0), node(1), node(2)) / static_cast<double>(grid.restDensity(n));
      }
    }
    return sum / count;
  };
  const double at_rest = density();
  WispState out;
  laboratory.advance(simulation, kSeconds, [&] {
    const double carried = std::min(1.0, simulation.time() / kCarrying);
    simulation.setBonePose("other", {Vec3(static_cast<float>(-kCarried * carried), 0, 0), Quat::Identity()});
    if (simulation.time() < kSeconds - kWatched) return;
    out.speed = worse(out.speed, 1e3 * rmsSpeedOf(simulation.state().velocities));
  });
  out.density = density() / at_rest;
  return out;
}

std::vector<Case> twoWisps(const Laboratory& laboratory) {
  const WispState on = carriedTogether(laboratory, kStiffness);
  return {absoluteCase({"two wisps: density", "of their outer halves, over that at rest", ""}, on.density, 1,
                       0.1),
          atLeastCase({"two wisps: into each other", "the same with volume_stiffness off", ""},
                      carriedTogether(laboratory, 0).density, 1.5, 0),
          absoluteCase({"two wisps: stop", "rms speed, the largest of the last half second", "mm/s"},
                       on.speed, 0, 1)};
}

}  // namespace

void addVolumeExperiments(std::vector<Experiment>& experiments) {
  experiments.push_back(
      {"two wisps of 100 limp strands, 4 cm wide, the roots of one carried by 8 cm into those of the other",
       {"two wisps: density", "two wisps: into each other", "two wisps: stop"},
       twoWisps});
  experiments.push_back({"a head of 1000 strands of 20 cm that are not sag-free, under gravity for 5 s",
                         namesOfFullHead(), fullHead});
  experiments.push_back({"impulses of one step in a squeezed head of hair",
                         {"momentum of pushes", "momentum of friction"},
                         momentum});
  experiments.push_back(
      {"a head of hair at rest without gravity", {"groom at rest: way", "groom at rest: push"}, atRest});
}

}  // namespace strandcast
