#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "validation/experiments.h"
#include "validation/hung_rod.h"
#include "validation/specimen.h"

namespace strandcast {
namespace {

constexpr double kCurvatures[] = {8, 10};  // natural curvature x length
constexpr double kParts[] = {0.91, 0.94, 0.97, 1,
                             1.03, 1.06, 1.09};  // gamma of the strands over the threshold

std::vector<std::string> namesOfThreshold() {
  return caseNames("bend-twist threshold phi={:g}", kCurvatures);
}

double outOfPlane(Simulation& simulation, size_t s) {
  double sum = 0;
  for (const Vec3& x : strandOf(simulation, s)) sum += static_cast<double>(x.z()) * x.z();
  return std::sqrt(sum);
}

// Strands that hang at rest in their plane get a small push out of it. Near the threshold the perturbation
// decays or grows at a rate that is linear in gamma; the threshold is the zero of the rate.
std::vector<Case> threshold(const Laboratory& laboratory) {
  constexpr double kSettling = 6, kPassing = 2, kWatching = 2;  // s
  constexpr float kPush = 0.005f;                               // m/s at the tip
  const Material hair;
  std::vector<StrandPoints> strands;
  std::vector<double> truth;
  for (const double phi : kCurvatures) {
    truth.push_back(bendTwistThreshold(phi, 1 / (1.0 + hair.poisson_ratio)));
    for (const double part : kParts) {
      const double length = lengthOfGamma(part * truth.back(), hair);
      strands.push_back(arcStrand(phi / length, length, kEdges));
    }
  }
  Simulation simulation = laboratory.simulation(modelOf(strands), laboratory.parameters(kRate, 5));
  laboratory.advance(simulation, kSettling);
  StrandState state = simulation.state();
  for (size_t v = 0; v < state.velocities.size(); ++v)
    state.velocities[v].z() += kPush * std::pow(static_cast<float>(v % (kEdges + 1)) / kEdges, 2.0f);
  simulation.backend().upload(state);
  laboratory.advance(simulation, kPassing);
  std::vector<double> before;
  for (size_t s = 0; s < strands.size(); ++s) before.push_back(outOfPlane(simulation, s));
  laboratory.advance(simulation, kWatching);

  std::vector<Case> cases;
  for (size_t c = 0; c < std::size(kCurvatures); ++c) {
    double crossing = std::numeric_limits<double>::quiet_NaN(), rate_before = 0;
    std::string note = "growth, 1/s:";
    for (size_t k = 0; k < std::size(kParts); ++k) {
      const size_t s = c * std::size(kParts) + k;
      const double rate = std::log(outOfPlane(simulation, s) / before[s]) / kWatching;
      note += fmt::format(" {:.3f}", rate);
      if (k > 0 && rate_before > 0 && rate <= 0)
        crossing = kParts[k - 1] + (kParts[k] - kParts[k - 1]) * rate_before / (rate_before - rate);
      rate_before = rate;
    }
    Case found = relativeCase({namesOfThreshold()[c], "gamma", ""}, crossing * truth[c], truth[c], 3);
    found.note = note + " at 0.91 to 1.09 of the truth";
    cases.push_back(found);
  }
  return cases;
}

// Rotation of frame b relative to frame a about their nearly parallel z axes, rad.
double twistBetween(const Quat& a, const Quat& b) {
  const Quat turn = a.conjugate() * b;
  return 2 * std::atan2(turn.w() < 0 ? -turn.z() : turn.z(), std::fabs(turn.w()));
}

// A quarter turn, then continued to two turns.
std::vector<Case> twist(const Laboratory& laboratory) {
  constexpr double kTurning = std::numbers::pi;  // rad/s
  constexpr double kDegree = std::numbers::pi / 180;
  const StrandPoints points = straightStrand(0.2, kEdges, -Vec3::UnitY());
  Simulation simulation = laboratory.simulation(modelOf({points}), laboratory.parameters(kRate, 5));
  Quat last = simulation.state().frames[kEdges - 1];
  double turned = 0, angle = 0;
  // The vertical axis is antiparallel to the strand, so a positive turn about it is a negative twist.
  auto turnTo = [&](double end) {
    const double begin = angle, start = simulation.time();
    int step = 0;
    auto motion = [&](double t) {
      angle = std::min(end, begin + kTurning * (t - start));
      return Pose{Vec3::Zero(), Quat(Eigen::AngleAxisf(static_cast<float>(angle), Eigen::Vector3f::UnitY()))};
    };
    laboratory.advance(simulation, (end - begin) / kTurning + 1, motion, [&] {
      if (++step % 4 != 0) return;
      const Quat now = simulation.state().frames[kEdges - 1];
      turned -= twistBetween(last, now);
      last = now;
    });
    return turned / kDegree;
  };
  std::vector<Case> cases;
  for (const double degrees : {90.0, 720.0})
    cases.push_back(
        relativeCase({fmt::format("root twist angle={:g}", degrees), "twist of the tip", "degrees"},
                     turnTo(degrees * kDegree), degrees, 1));
  return cases;
}

}  // namespace

void addBendTwistExperiments(std::vector<Experiment>& experiments) {
  experiments.push_back(
      {"naturally curved strands hang in their plane or leave it", namesOfThreshold(), threshold});
  experiments.push_back({"the root of a hanging strand turns about its axis",
                         {"root twist angle=90", "root twist angle=720"},
                         twist});
}

}  // namespace strandcast
