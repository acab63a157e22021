#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "validation/experiments.h"
#include "validation/specimen.h"
#include "validation/vibrations.h"

namespace strandcast {
namespace {

constexpr double kSwing = 0.01;  // amplitude of a mode at the tip over the length; small

using ModeShape = std::function<double(int mode, double place)>;

// Strand s starts straight, with the velocities of mode s + 1 along `across`. Returns the amplitude of that
// mode over time.
std::vector<std::vector<double>> modeAmplitudes(const Laboratory& laboratory, Simulation& simulation,
                                                const ModeShape& shape,
                                                const std::vector<double>& frequencies, const Vec3& across,
                                                double seconds) {
  const StrandModel& model = simulation.model();
  StrandState state = simulation.state();
  std::vector<float> shapes(model.vertices());
  for (size_t s = 0; s < model.strands(); ++s) {
    const uint32_t first = model.offsets[s], last = model.offsets[s + 1] - 1;
    const float length = (state.positions[last] - state.positions[first]).norm();
    for (uint32_t v = first; v <= last; ++v) {
      const double place = static_cast<double>(v - first) / (last - first);
      shapes[v] = static_cast<float>(shape(static_cast<int>(s) + 1, place));
      state.velocities[v] = across * (shapes[v] * length * static_cast<float>(kSwing * frequencies[s]));
    }
  }
  simulation.backend().upload(state);
  std::vector<std::vector<double>> amplitudes(model.strands());
  laboratory.advance(simulation, seconds, [&] {
    const std::span<const Vec3> positions = simulation.guides();
    for (size_t s = 0; s < model.strands(); ++s) {
      double sum = 0;
      for (uint32_t v = model.offsets[s] + 1; v < model.offsets[s + 1]; ++v)
        sum += static_cast<double>(model.mass[v]) * shapes[v] * across.dot(positions[v]);
      amplitudes[s].push_back(sum);
    }
  });
  return amplitudes;
}

double shapeOfBeam(int mode, double place) { return beamShape(mode, place) / beamShape(mode, 1); }

std::vector<double> beamFrequencies(double length) {
  const double unit = std::sqrt(bendingOverMass(Material{})) / (length * length);
  return {std::pow(beamRoot(1), 2) * unit, std::pow(beamRoot(2), 2) * unit};
}

constexpr double kBeamLength = 0.2;  // m

std::vector<Oscillation> beamOscillations(const Laboratory& laboratory, float damping_time,
                                          const Material& material = {}) {
  const StrandPoints points = straightStrand(kBeamLength, kEdges, Vec3::UnitX());
  Parameters parameters = laboratory.parameters(kRate, 0);
  parameters.gravity = Vec3::Zero();
  parameters.damping_time = damping_time;
  Simulation simulation = laboratory.simulation(modelOf({points, points}, material), parameters);
  std::vector<Oscillation> out;
  for (const auto& samples :
       modeAmplitudes(laboratory, simulation, shapeOfBeam, beamFrequencies(kBeamLength), Vec3::UnitY(), 8))
    out.push_back(oscillationOf(samples, 1 / kRate));
  return out;
}

// Mean arc length of mode 1, weighted with the square of its curvature, to which the dissipation is
// proportional.
double bentPlaceOfBeam() {
  constexpr int kPlaces = 1000;
  constexpr double kStep = 1.0 / kPlaces;
  double sum = 0, weights = 0;
  for (int i = 0; i < kPlaces; ++i) {
    const double s = (i + 0.5) * kStep;
    const double curvature = beamShape(1, s - kStep) - 2 * beamShape(1, s) + beamShape(1, s + kStep);
    weights += curvature * curvature;
    sum += curvature * curvature * s;
  }
  return sum / weights;
}

constexpr const char* kDampedOutwards = "internal damping, to twice from 0";

std::vector<Case> beam(const Laboratory& laboratory) {
  constexpr float kDampingTime = 0.02f;  // s
  const std::vector<double> truth = beamFrequencies(kBeamLength);
  const std::vector<Oscillation> free = beamOscillations(laboratory, 0);
  const std::vector<Oscillation> damped = beamOscillations(laboratory, kDampingTime);
  std::vector<Case> cases;
  for (int mode = 1; mode <= 2; ++mode)
    cases.push_back(relativeCase({fmt::format("beam mode={}", mode), "angular frequency", "rad/s"},
                                 free[mode - 1].angular_frequency, truth[mode - 1], 2));
  Case scheme = absoluteCase({"damping of the scheme", "damping ratio", ""}, free[0].dampingRatio(), 0,
                             truth[0] / (2 * kRate));
  scheme.note = "limit: that of implicit Euler, omega dt / 2";
  cases.push_back(scheme);
  Case internal =
      relativeCase({"internal damping", "damping ratio", ""},
                   damped[0].dampingRatio() - free[0].dampingRatio(), truth[0] * kDampingTime / 2, 10);
  internal.note = fmt::format("damping time {:g} s, less what there is without it", kDampingTime);
  cases.push_back(internal);
  Material outwards;
  outwards.damping_curve.knots = {{0, 0}, {1, 2}};
  const std::vector<Oscillation> growing = beamOscillations(laboratory, kDampingTime, outwards);
  Case along =
      relativeCase({kDampedOutwards, "damping ratio", ""}, growing[0].dampingRatio() - free[0].dampingRatio(),
                   truth[0] * kDampingTime / 2 * 2 * bentPlaceOfBeam(), 10);
  along.note = "a damping_curve from 0 to 2; less what there is without damping";
  cases.push_back(along);
  return cases;
}

Material limp() {
  Material material;
  material.youngs_modulus = 1e3f;
  return material;
}

std::vector<Case> chain(const Laboratory& laboratory) {
  constexpr double kLimits[] = {1, 3, 3};
  const StrandPoints points = straightStrand(kHairLength, kEdges, -Vec3::UnitY());
  Simulation simulation =
      laboratory.simulation(modelOf({points, points, points}, limp()), laboratory.parameters(kRate, 0));
  laboratory.advance(simulation, 1);  // tensions settle
  std::vector<double> truth;
  for (int mode = 1; mode <= 3; ++mode)
    truth.push_back(chainRoot(mode) / 2 * std::sqrt(kGravity / kHairLength));
  const auto amplitudes = modeAmplitudes(laboratory, simulation, chainShape, truth, Vec3::UnitX(), 5);
  std::vector<Case> cases;
  for (int mode = 1; mode <= 3; ++mode) {
    const Oscillation swing = oscillationOf(amplitudes[mode - 1], 1 / kRate);
    cases.push_back(relativeCase({fmt::format("chain mode={}", mode), "period", "s"},
                                 2 * std::numbers::pi / swing.angular_frequency,
                                 2 * std::numbers::pi / truth[mode - 1], kLimits[mode - 1]));
    if (mode == 1)
      cases.push_back(absoluteCase({"chain energy lost per cycle", "energy lost", "%"},
                                   100 * swing.energyLostPerCycle(), 0, 2));
  }
  return cases;
}

constexpr double kLightTip = 0.1, kHeavyTip = 5;  // mass per length at the tip over that at the clamp

std::vector<std::string> namesOfUnevenChains() {
  std::vector<std::string> names;
  for (const double tip : {kLightTip, kHeavyTip})
    for (const int mode : {1, 2})
      names.push_back(fmt::format("chain evenly up to {:g} x as dense mode={}", tip, mode));
  return names;
}

std::vector<Case> unevenChains(const Laboratory& laboratory) {
  constexpr double kLimits[] = {1, 3};
  const std::vector<std::string> names = namesOfUnevenChains();
  const StrandPoints points = straightStrand(kHairLength, kEdges, -Vec3::UnitY());
  std::vector<Case> cases;
  for (const double tip : {kLightTip, kHeavyTip}) {
    Material material = limp();
    material.density_scale.knots = {{0, 1}, {1, static_cast<float>(tip)}};
    Simulation simulation =
        laboratory.simulation(modelOf({points, points}, material), laboratory.parameters(kRate, 0));
    laboratory.advance(simulation, 1);
    const UnevenChain modes[] = {{1, tip}, {2, tip}};
    std::vector<double> truth;
    for (const UnevenChain& mode : modes)
      truth.push_back(mode.frequency() * std::sqrt(kGravity / kHairLength));
    const auto shape = [&](int mode, double place) { return modes[mode - 1].shape(place); };
    const auto amplitudes = modeAmplitudes(laboratory, simulation, shape, truth, Vec3::UnitX(), 5);
    for (size_t m = 0; m < std::size(modes); ++m)
      cases.push_back(
          relativeCase({names[cases.size()], "period", "s"},
                       2 * std::numbers::pi / oscillationOf(amplitudes[m], 1 / kRate).angular_frequency,
                       2 * std::numbers::pi / truth[m], kLimits[m]));
  }
  return cases;
}

constexpr const char* kThickAir = "chain in thick air";

// Overdamped by air drag: the first mode decays without oscillation.
std::vector<Case> chainInThickAir(const Laboratory& laboratory) {
  constexpr double kDrag = 100, kFrom = 0.5, kTo = 2;  // 1/s; s
  const StrandPoints points = straightStrand(kHairLength, kEdges, -Vec3::UnitY());
  Simulation simulation =
      laboratory.simulation(modelOf({points}, limp()), laboratory.parameters(kRate, kDrag));
  laboratory.advance(simulation, 1);
  const double frequency = chainRoot(1) / 2 * std::sqrt(kGravity / kHairLength);
  const std::vector<double> amplitude =
      modeAmplitudes(laboratory, simulation, chainShape, {frequency}, Vec3::UnitX(), kTo)[0];
  const size_t from = static_cast<size_t>(kFrom * kRate), to = amplitude.size() - 1;
  const double rate = std::log(amplitude[from] / amplitude[to]) * kRate / static_cast<double>(to - from);
  const double truth = kDrag / 2 - std::sqrt(kDrag * kDrag / 4 - frequency * frequency);
  return {relativeCase({kThickAir, "rate at which it comes to hang", "1/s"}, rate, truth, 2)};
}

constexpr double kAngles[] = {30, 90};  // degrees

std::vector<std::string> namesOfPendulum() { return caseNames("pendulum angle={:g}", kAngles); }

std::vector<Case> pendulum(const Laboratory& laboratory) {
  std::vector<StrandPoints> strands;
  for (const double degrees : kAngles) {
    const double angle = degrees * std::numbers::pi / 180;
    strands.push_back(
        straightStrand(kHairLength, 1, Eigen::Vector3d(std::sin(angle), -std::cos(angle), 0).cast<float>()));
  }
  Simulation simulation = laboratory.simulation(modelOf(strands, limp()), laboratory.parameters(kRate, 0));
  std::vector<std::vector<double>> swings(strands.size());
  laboratory.advance(simulation, 3, [&] {
    for (size_t s = 0; s < strands.size(); ++s) swings[s].push_back(tipOf(simulation, s).x());
  });
  std::vector<Case> cases;
  for (size_t s = 0; s < strands.size(); ++s) {
    const Oscillation swing = oscillationOf(swings[s], 1 / kRate);
    const double small = 2 * std::numbers::pi * std::sqrt(kHairLength / kGravity);
    Case period =
        relativeCase({namesOfPendulum()[s], "period", "s"}, 2 * std::numbers::pi / swing.angular_frequency,
                     small * pendulumPeriod(kAngles[s] * std::numbers::pi / 180), 1);
    period.note = fmt::format("loses {:.2f} % of its energy per cycle", 100 * swing.energyLostPerCycle());
    cases.push_back(period);
  }
  return cases;
}

}  // namespace

void addVibrationExperiments(std::vector<Experiment>& experiments) {
  experiments.push_back(
      {"straight strands without weight vibrate, clamped at the root",
       {"beam mode=1", "beam mode=2", "damping of the scheme", "internal damping", kDampedOutwards},
       beam});
  experiments.push_back({"limp strands hang and swing as chains do",
                         {"chain mode=1", "chain energy lost per cycle", "chain mode=2", "chain mode=3"},
                         chain});
  experiments.push_back(
      {"the same, lighter or heavier from root to tip", namesOfUnevenChains(), unevenChains});
  experiments.push_back({"a limp strand comes to hang in thick air", {kThickAir}, chainInThickAir});
  experiments.push_back({"limp strands of one edge swing as pendulums do", namesOfPendulum(), pendulum});
}

namespace {

std::vector<StrandPoints> straightAndCurl() {
  return {straightStrand(kHairLength, kEdges, -Vec3::UnitY()), helixStrand(0.01, 0.01, kHairLength, kEdges)};
}

std::vector<Case> stretch(const Laboratory& laboratory) {
  Simulation simulation = laboratory.simulation(modelOf(straightAndCurl()), laboratory.parameters(kRate, 1));
  laboratory.advance(simulation, 4);
  double resting = 0, shaking = 0, turning = 0;
  auto keepLargest = [&](double& largest) {
    return [&] { largest = worse(largest, stretchOf(simulation)); };
  };
  laboratory.advance(simulation, 0.5, keepLargest(resting));
  // At 5 Hz an amplitude of 0.0994 m is 10 g.
  const double reach = 10 * kGravity / std::pow(2 * std::numbers::pi * 5, 2);
  const double start = simulation.time();
  laboratory.advance(
      simulation, 2,
      [&](double t) { return shakenRoot(t - start, {.reach = reach, .shakes = 5, .turns = 0}); },
      keepLargest(shaking));
  const double then = simulation.time();
  laboratory.advance(
      simulation, 2, [&](double t) { return shakenRoot(t - then, {.reach = 0}); }, keepLargest(turning));
  return {absoluteCase({"stretch at rest", "largest stretch", "%"}, resting, 0, 1e-3),
          absoluteCase({"stretch under a shake of 10 g", "largest stretch", "%"}, shaking, 0, 1e-2),
          absoluteCase({"stretch under turns of 45 degrees", "largest stretch", "%"}, turning, 0, 1e-2)};
}

// Paths of the tips, sampled at kRate with any time step.
std::vector<std::vector<Vec3>> tipPaths(const Laboratory& laboratory, int steps_per_sample) {
  Simulation simulation =
      laboratory.simulation(modelOf(straightAndCurl()), laboratory.parameters(kRate * steps_per_sample, 2));
  std::vector<std::vector<Vec3>> paths(2);
  int step = 0;
  laboratory.advance(
      simulation, 1.5, [](double t) { return shakenRoot(t); },
      [&] {
        if (++step % steps_per_sample != 0) return;
        for (size_t s = 0; s < paths.size(); ++s) paths[s].push_back(tipOf(simulation, s));
      });
  return paths;
}

double rootMeanSquare(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]).cast<double>().squaredNorm();
  return std::sqrt(sum / static_cast<double>(a.size()));
}

std::vector<Case> shake(const Laboratory& laboratory) {
  const Laboratory fine(makeOracleBackend, SolverKind::kRod);
  const auto truth = tipPaths(fine, 32), measured = tipPaths(laboratory, 1), halved = tipPaths(laboratory, 2);
  std::vector<Case> cases;
  const char* names[] = {"tip error straight", "tip error curl"};
  constexpr double kLimits[] = {5, 12};  // mm
  for (size_t s = 0; s < truth.size(); ++s) {
    cases.push_back(absoluteCase({names[s], "root mean square", "mm"},
                                 1e3 * rootMeanSquare(measured[s], truth[s]), 0, kLimits[s]));
    cases.back().note = fmt::format(
        "truth: the rod in double precision at 1/11520 s, the same vertices; at 1/720 s: {:.2f} mm",
        1e3 * rootMeanSquare(halved[s], truth[s]));
  }
  return cases;
}

}  // namespace

void addMotionExperiments(std::vector<Experiment>& experiments) {
  experiments.push_back(
      {"lengths at rest, under a shake of 10 g at 5 Hz and under turns of 45 degrees at 1 Hz",
       {"stretch at rest", "stretch under a shake of 10 g", "stretch under turns of 45 degrees"},
       stretch});
  experiments.push_back({"a strand of 25 cm, its root shaken by 0.1 m and 45 degrees at 1 Hz for 1.5 s",
                         {"tip error straight", "tip error curl"},
                         shake});
}

}  // namespace strandcast
