#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "validation/experiments.h"
#include "validation/shaken_root.h"
#include "validation/specimen.h"

namespace strandcast {
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
