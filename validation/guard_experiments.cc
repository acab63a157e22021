#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>

#include "core/error.h"
#include "validation/experiments.h"
#include "validation/specimen.h"

namespace strandcast {
namespace {

constexpr float kStressDrag = 5;

// An abuse of hair at rest; calls `look` after every step.
using StressTest = std::function<void(const Laboratory&, Simulation&, const std::function<void()>& look)>;

// Strands settle, are abused and settle again. Cases: numbers that are not finite at any step, and the
// largest distance of the tips from their first rest position over the last second, mm.
std::vector<Case> stressCases(const Laboratory& laboratory, const std::string& name, const Material& material,
                              const Parameters& parameters, const StressTest& abuse) {
  constexpr double kSettling = 6, kWatching = 1;  // s
  Simulation simulation = laboratory.simulation(
      modelOf({straightStrand(0.25, kEdges, Vec3::UnitX()), helixStrand(0.01, 0.01, 0.2, kEdges)}, material),
      parameters);
  size_t non_finite = 0;
  auto look = [&] { non_finite = std::max(non_finite, simulation.measure().non_finite); };
  laboratory.advance(simulation, kSettling, look);
  const Vec3 before[] = {tipOf(simulation, 0), tipOf(simulation, 1)};
  abuse(laboratory, simulation, look);
  simulation.setParameters(parameters);
  auto back = [](double) { return Pose{}; };
  laboratory.advance(simulation, kSettling - kWatching, back, look);
  double moved = 0;
  laboratory.advance(simulation, kWatching, back, [&] {
    look();
    for (size_t s = 0; s < 2; ++s)
      moved = worse(moved, 1e3 * (tipOf(simulation, s) - before[s]).cast<double>().norm());
  });
  return {absoluteCase({name + ": finite", "numbers not finite", ""}, static_cast<double>(non_finite), 0, 0),
          absoluteCase({name + ": returns", "largest distance of a tip", "mm"}, moved, 0, 1)};
}

Pose shaken(double t) {
  return {Vec3(static_cast<float>(0.1 * std::sin(2 * std::numbers::pi * 5 * t)), 0, 0),
          Quat(Eigen::AngleAxisf(static_cast<float>(0.8 * std::sin(9 * t)), Eigen::Vector3f::UnitY()))};
}

void shakeFor(const Laboratory& laboratory, Simulation& simulation, double seconds,
              const std::function<void()>& look) {
  const double start = simulation.time();
  laboratory.advance(
      simulation, seconds, [&](double t) { return shaken(t - start); }, look);
}

void shakeForThreeSeconds(const Laboratory& laboratory, Simulation& simulation,
                          const std::function<void()>& look) {
  shakeFor(laboratory, simulation, 3, look);
}

Material hairTimes(float stiffness) {
  Material material;
  material.youngs_modulus *= stiffness;
  return material;
}

std::vector<Case> stiff(const Laboratory& laboratory) {
  return stressCases(laboratory, "1000 times the stiffness", hairTimes(1000),
                     laboratory.parameters(kRate, kStressDrag), shakeForThreeSeconds);
}

std::vector<Case> leap(const Laboratory& laboratory) {
  return stressCases(laboratory, "leap of 1 m", {}, laboratory.parameters(kRate, kStressDrag),
                     [](const Laboratory& lab, Simulation& simulation, const auto& look) {
                       lab.advance(
                           simulation, 1,
                           [](double) {
                             return Pose{Vec3(0.6f, 0.0f, 0.8f), Quat::Identity()};
                           },
                           look);
                     });
}

std::vector<Case> timeSteps(const Laboratory& laboratory) {
  return stressCases(laboratory, "changing time steps", {}, laboratory.parameters(kRate, kStressDrag),
                     [](const Laboratory& lab, Simulation& simulation, const auto& look) {
                       for (const double rate : {30, 2000, 60, 1000, 30}) {
                         simulation.setParameters(lab.parameters(rate, kStressDrag));
                         shakeFor(lab, simulation, 0.5, look);
                       }
                     });
}

std::vector<Case> substeps(const Laboratory& laboratory) {
  return stressCases(laboratory, "changing substeps", {}, laboratory.parameters(kRate, kStressDrag),
                     [](const Laboratory& lab, Simulation& simulation, const auto& look) {
                       for (const int substeps : {1, 64, 2, 16, 1}) {
                         Parameters parameters = lab.parameters(60, kStressDrag);
                         parameters.substeps = substeps;
                         simulation.setParameters(parameters);
                         shakeFor(lab, simulation, 0.5, look);
                       }
                     });
}

constexpr int kConstantRates[] = {30, 60, 2000};  // steps per second

std::string nameOfRate(int rate) { return fmt::format("time step of 1/{} s", rate); }

std::vector<Case> constantStep(const Laboratory& laboratory, int rate) {
  return stressCases(laboratory, nameOfRate(rate), {}, laboratory.parameters(rate, kStressDrag),
                     shakeForThreeSeconds);
}

std::vector<Case> maxSubsteps(const Laboratory& laboratory) {
  Parameters parameters = laboratory.parameters(30, kStressDrag);
  parameters.substeps = 64;
  return stressCases(laboratory, "64 substeps", {}, parameters, shakeForThreeSeconds);
}

std::vector<Case> shortestSubsteps(const Laboratory& laboratory) {
  Parameters parameters = laboratory.parameters(2000, kStressDrag);
  parameters.substeps = 64;
  return stressCases(laboratory, "64 substeps of 1/2000 s", {}, parameters, shakeForThreeSeconds);
}

std::vector<Case> dampedShake(const Laboratory& laboratory) {
  Parameters parameters = laboratory.parameters(kRate, kStressDrag);
  parameters.damping_time = 0.1f;  // 36 substeps
  return stressCases(laboratory, "internal damping of 0.1 s", {}, parameters, shakeForThreeSeconds);
}

std::vector<Case> coincident(const Laboratory& laboratory) {
  return stressCases(laboratory, "coincident vertices", {}, laboratory.parameters(kRate, kStressDrag),
                     [](const Laboratory& lab, Simulation& simulation, const auto& look) {
                       StrandState state = simulation.state();
                       for (size_t v = 10; v < 20; ++v) state.positions[v] = state.positions[10];
                       simulation.backend().upload(state);
                       lab.advance(simulation, 1, look);
                       for (size_t v = 0; v < state.positions.size(); ++v) state.positions[v] = Vec3::Zero();
                       simulation.backend().upload(state);
                       lab.advance(simulation, 1, look);
                     });
}

// Random lengths, shapes and stiffnesses within the range of the float solver; every second strand is a
// helix.
struct MixedHair {
  std::vector<StrandPoints> strands;
  std::vector<Material> materials;
};

MixedHair mixedHair(size_t count) {
  constexpr double kDensest = 3000;  // B dt^2 / (mass per length x edge^4)
  std::mt19937 random(7);
  auto between = [&](double low, double high) { return low + (high - low) * random() / 4294967296.0; };
  MixedHair hair;
  while (hair.strands.size() < count) {
    const double length = between(0.1, 0.3);
    int edges = static_cast<int>(between(8, 64));
    double stiffness = std::pow(10, between(0, 3));
    if (hair.strands.size() % 2 == 0) {
      const Vec3 direction(static_cast<float>(between(-0.5, 0.5)), static_cast<float>(between(-0.7, 0.3)),
                           static_cast<float>(between(-0.5, 0.5)));
      hair.strands.push_back(straightStrand(length, edges, direction.normalized()));
    } else {
      constexpr double kEdgesPerTurn = 12;
      const double radius = between(0.003, 0.015), pitch = between(0.01, 0.04);
      const double turn = std::hypot(2 * std::numbers::pi * radius, pitch);
      edges = std::min(std::max(edges, static_cast<int>(length / turn * kEdgesPerTurn)), 100);
      hair.strands.push_back(helixStrand(radius, pitch, length, edges));
    }
    const double density = bendingOverMass({}) / std::pow(kRate, 2) / std::pow(length / edges, 4);
    stiffness = std::min(stiffness, kDensest / density);
    hair.materials.push_back(hairTimes(static_cast<float>(stiffness)));
  }
  return hair;
}

// Hair that was shaken and carried must come to rest: the solver must not feed energy into a strand.
constexpr const char* kThrown = "thrown about: at rest";

std::vector<Case> thrown(const Laboratory& laboratory) {
  constexpr size_t kStrands = 100;
  constexpr double kShaking = 1, kCarrying = 0.3, kResting = 6;  // s
  constexpr double kMoving = 0.01;                               // m/s
  const MixedHair hair = mixedHair(kStrands);
  Simulation simulation =
      laboratory.simulation(modelOf(hair.strands, hair.materials), laboratory.parameters(kRate, 2));
  shakeFor(laboratory, simulation, kShaking, {});
  const double start = simulation.time();
  laboratory.advance(
      simulation, kCarrying + kResting,
      [&](double t) {
        return Pose{Vec3(static_cast<float>(std::min(0.5, 2 * (t - start))), 0, 0), Quat::Identity()};
      },
      {});
  const StrandState state = simulation.state();
  double moving = 0;
  for (size_t s = 0; s < kStrands; ++s)
    if (!(rmsSpeedOf(simulation.model(), state, s) < kMoving)) ++moving;
  return {absoluteCase({kThrown, "strands of 100 faster than 10 mm/s", ""}, moving, 0, 1)};
}

// Hair of many short edges with a kink at every joint; stiffness ratio kappa 330 to 1600.
constexpr const char *kKinked = "kinked: at rest", *kKinkedBesideABall = "kinked: at rest beside a ball";

std::vector<Case> kinked(const Laboratory& laboratory, const char* name,
                         const std::vector<RigidBody>& bodies) {
  constexpr int kStrands = 8;
  constexpr double kSettling = 8;   // s
  constexpr double kMoving = 0.02;  // m/s
  std::mt19937 random(7);
  auto any = [&] { return anyNumber(random); };
  std::vector<StrandPoints> strands;
  for (int s = 0; s < kStrands; ++s)
    strands.push_back(kinkedStrand(Vec3::Zero(), Vec3(any(), any(), any()).normalized(),
                                   s % 2 == 0 ? 0.1f : 0.2f, s % 2 == 0 ? 63 : 95, 0.1f, random));
  Simulation simulation = laboratory.simulation(modelOf(strands, std::vector<Material>(strands.size())),
                                                bodies, laboratory.parameters(kRate, kStressDrag));
  laboratory.advance(simulation, kSettling, {});
  const StrandState state = simulation.state();
  double moving = 0;
  for (size_t s = 0; s < kStrands; ++s)
    if (!(rmsSpeedOf(simulation.model(), state, s) < kMoving)) ++moving;
  return {absoluteCase({name, "strands of 8 faster than 20 mm/s", ""}, moving, 0, 0)};
}

// Hair of 24 to 48 edges with turns of 7 to 30 degrees at each joint. In the metric for smooth hair its
// length constraints drove an undamped small oscillation.
constexpr const char* kKinkedFromEdgeToEdge = "kinked from edge to edge: speed";

std::vector<Case> kinkedFromEdgeToEdge(const Laboratory& laboratory) {
  constexpr int kStrands = 32;
  constexpr double kSettling = 6;  // s
  std::mt19937 random(11);
  auto any = [&] { return anyNumber(random); };
  std::vector<StrandPoints> strands;
  for (int s = 0; s < kStrands; ++s)
    strands.push_back(kinkedStrand(Vec3::Zero(), Vec3(any(), any(), any()).normalized(),
                                   s % 2 == 0 ? 0.12f : 0.25f, 24 + 8 * (s / 2 % 4),
                                   0.15f + 0.5f * static_cast<float>(s) / kStrands, random));
  Simulation simulation =
      laboratory.simulation(modelOf(strands), {}, laboratory.parameters(kRate, kStressDrag));
  laboratory.advance(simulation, kSettling);
  return {absoluteCase({kKinkedFromEdgeToEdge, "largest rms speed of a strand after 6 s", "mm/s"},
                       1e3 * fastestOf(simulation), 0, 5)};
}

// A strand with one edge much shorter than the others. A separate time blend for that edge added energy.
constexpr const char* kCutUnevenly = "cut unevenly: speed";

std::vector<Case> cutUnevenly(const Laboratory& laboratory) {
  constexpr int kStrands = 24;
  constexpr double kSettling = 8;  // s
  std::mt19937 random(7);
  std::vector<StrandPoints> strands;
  for (int s = 0; s < kStrands; ++s) {
    const float part =
        0.12f + 0.01f * static_cast<float>(s);  // length of the short edge over that of the others
    const float length = s % 2 == 0 ? 0.1f : 0.25f, edge = length / (static_cast<float>(kEdges) + part);
    const int short_one = static_cast<int>(random() % static_cast<unsigned>(kEdges + 1));
    StrandPoints points{Vec3::Zero()};
    for (int e = 0; e <= kEdges; ++e)
      points.push_back(points.back() + (e == short_one ? part : 1.0f) * edge * Vec3::UnitX());
    strands.push_back(std::move(points));
  }
  Simulation simulation =
      laboratory.simulation(modelOf(strands), {}, laboratory.parameters(kRate, kStressDrag));
  laboratory.advance(simulation, kSettling);
  return {absoluteCase({kCutUnevenly, "largest rms speed of a strand after 8 s", "mm/s"},
                       1e3 * fastestOf(simulation), 0, 1)};
}

// Wind whose drag on hair at rest is 30 times its weight; compared with gravity of the same strength.
constexpr const char *kStrongWind = "strong wind: speed", *kStrongWindTension = "strong wind: tension";

std::vector<Case> strongWind(const Laboratory& laboratory) {
  constexpr float kWindDrag = 30, kPull = 300;  // 1/s, m/s^2
  constexpr double kSettling = 8;               // s
  auto settled = [&](const Vec3& wind, const Vec3& more_gravity) {
    Parameters parameters = laboratory.parameters(kRate, kWindDrag);
    parameters.wind = wind;
    parameters.gravity += more_gravity;
    Simulation simulation =
        laboratory.simulation(modelOf({straightStrand(0.25, kEdges, Vec3::UnitX())}), {}, parameters);
    laboratory.advance(simulation, kSettling);
    return std::pair(fastestOf(simulation), static_cast<double>(simulation.state().tensions[0]));
  };
  const auto [fastest, tension] = settled(kPull / kWindDrag * Vec3::UnitZ(), Vec3::Zero());
  const double truth = settled(Vec3::Zero(), kPull * Vec3::UnitZ()).second;
  return {absoluteCase({kStrongWind, "rms speed of the strand after 8 s", "mm/s"}, 1e3 * fastest, 0, 1),
          relativeCase({kStrongWindTension, "at the root, against gravity that pulls as hard", "m/s^2"},
                       tension, truth, 0.1)};
}

// Hair of 25 cm pinned at both ends, as in a braid or a bun: flat arches, horizontal and inclined. The length
// exceeds the distance of the ends by the fraction `slack` of the length.
StrandModel hairBetweenPins(int strands, double slack) {
  constexpr int kManyEdges = 60;
  constexpr float kLength = 0.25f;  // m
  const auto arch = static_cast<float>(std::sqrt(24 * slack));
  std::vector<StrandPoints> all;
  for (int s = 0; s < strands; ++s) {
    const double around = 0.3 * s;
    const Vec3 along =
        Vec3(static_cast<float>(std::cos(around)), static_cast<float>(0.2 * std::sin(2 * around)),
             static_cast<float>(std::sin(around)))
            .normalized();
    StrandPoints points = {Vec3(0.1f, 0, 0.02f * static_cast<float>(s))};
    for (int e = 0; e < kManyEdges; ++e) {
      const float place = (static_cast<float>(e) + 0.5f) / kManyEdges - 0.5f;
      const Vec3 edge = (along + arch * place * Vec3::UnitY()).normalized();
      points.push_back(points.back() + kLength / kManyEdges * edge);
    }
    all.push_back(points);
  }
  StrandModel model = modelOf(all);
  model.pinned.assign(model.vertices(), 0);
  for (size_t s = 0; s < model.strands(); ++s)
    model.pinned[model.offsets[s]] = model.pinned[model.offsets[s + 1] - 1] = 1;
  return model;
}

// Released in place with no slack, nearly none and a little: it must come to rest.
constexpr double kSlacks[] = {0, 3e-5, 1e-3};

std::vector<std::string> namesOfSlack() { return caseNames("between pins, slack={:g}: at rest", kSlacks); }

std::vector<Case> nearlyTaut(const Laboratory& laboratory) {
  constexpr double kResting = 4;  // s
  Parameters parameters = laboratory.parameters(60, kStressDrag);
  parameters.substeps = 6;
  std::vector<Case> cases;
  for (size_t i = 0; i < std::size(kSlacks); ++i) {
    Simulation simulation = laboratory.simulation(hairBetweenPins(4, kSlacks[i]), {}, parameters);
    laboratory.advance(simulation, kResting);
    cases.push_back(absoluteCase({namesOfSlack()[i], "largest rms speed of a strand after 4 s", "mm/s"},
                                 1e3 * fastestOf(simulation), 0, 1));
  }
  return cases;
}

// A quick turn of the head must not leave nearly taut hair crumpled.
constexpr const char *kTautStretch = "taut between pins, shaken: stretch",
                     *kTautRest = "taut between pins: at rest";

std::vector<Case> tautBetweenPins(const Laboratory& laboratory) {
  constexpr int kStrands = 16;
  constexpr double kShaking = 2, kResting = 4;        // s
  constexpr double kTurn = 1.2, kWay = 0.1, kHz = 3;  // radians, m
  constexpr double kMoving = 0.005;                   // m/s
  Parameters parameters = laboratory.parameters(60, kStressDrag);
  parameters.substeps = 4;
  Simulation simulation = laboratory.simulation(hairBetweenPins(kStrands, 5e-4), {}, parameters);
  double stretch = 0;
  laboratory.advance(
      simulation, kShaking,
      [&](double t) {
        const double swing =
            std::sin(std::numbers::pi * t / kShaking) * std::sin(2 * std::numbers::pi * kHz * t);
        return Pose{Vec3(0, 0, static_cast<float>(kWay * swing)),
                    Quat(Eigen::AngleAxisf(static_cast<float>(kTurn * swing), Vec3::UnitY()))};
      },
      [&] { stretch = worse(stretch, stretchOf(simulation)); });
  laboratory.advance(simulation, kResting);
  const StrandState state = simulation.state();
  double moving = 0;
  for (size_t s = 0; s < kStrands; ++s)
    if (!(rmsSpeedOf(simulation.model(), state, s) < kMoving)) ++moving;
  return {absoluteCase({kTautStretch, "largest of an edge", "%"}, stretch, 0, 50),
          absoluteCase({kTautRest, "strands of 16 faster than 5 mm/s after 4 s", ""}, moving, 0, 0)};
}

// Far from the world's origin: the spacing of floats is 0.06 mm there.
constexpr const char *kFarStretch = "1 km from the origin: stretch",
                     *kFarSpeed = "1 km from the origin: speed";

std::vector<Case> farAway(const Laboratory& laboratory) {
  const Pose there{Vec3(1000, 2, -1000), Quat::Identity()};
  std::mt19937 random(3);
  std::vector<StrandPoints> strands;
  for (int s = 0; s < 16; ++s)
    strands.push_back(kinkedStrand(0.01f * Vec3(anyNumber(random), anyNumber(random), anyNumber(random)),
                                   Vec3::UnitX(), 0.2f, 32, 0.02f, random));
  Simulation simulation =
      laboratory.simulation(modelOf(strands), {}, laboratory.parameters(kRate, kStressDrag));
  simulation.teleport(there);
  double stretch = 0;
  const auto look = [&] { stretch = worse(stretch, stretchOf(simulation)); };
  laboratory.advance(
      simulation, 1, [&](double t) { return there * shaken(t); }, look);
  laboratory.advance(
      simulation, 4, [&](double) { return there; }, look);
  return {absoluteCase({kFarStretch, "largest of an edge, shaken and at rest", "%"}, stretch, 0, 0.01),
          absoluteCase({kFarSpeed, "largest rms speed of a strand after 4 s", "mm/s"},
                       1e3 * fastestOf(simulation), 0, 1)};
}

// Input that is not finite must be refused. Two equal simulations run, one of which gets such input. Counted
// are inputs that were accepted and vertices whose motion differs.
constexpr const char* kRefused = "input that is not finite: refused";

std::vector<Case> refused(const Laboratory& laboratory) {
  const Parameters parameters = laboratory.parameters(kRate, kStressDrag);
  const auto made = [&] {
    return laboratory.simulation(modelOf({straightStrand(0.25, kEdges, Vec3::UnitX())}), parameters);
  };
  Simulation told = made(), untold = made();
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  const Quat unturned = Quat::Identity();
  Parameters windy = parameters, heavy = parameters, timeless = parameters;
  windy.wind.y() = nan;
  heavy.gravity.y() = -inf;
  timeless.time_step = nan;
  const std::function<void()> bad[] = {
      [&] {
        told.setHeadPose({Vec3(nan, 0, 0), unturned});
      },
      [&] {
        told.setHeadPose({Vec3::Zero(), Quat(nan, 0, 0, 0)});
      },
      [&] {
        told.teleport({Vec3(0, inf, 0), unturned});
      },
      [&] { told.setParameters(windy); },
      [&] { told.setParameters(heavy); },
      [&] { told.setParameters(timeless); },
      [&] {
        told.addBody({{{PrimitiveKind::kSphere, Vec3(nan, 0, 0), Vec3::Zero(), 0.1f}}, false});
      },
  };
  double wrong = 0;
  for (const std::function<void()>& input : bad) {
    bool taken = true;
    try {
      input();
    } catch (const Error&) {
      taken = false;
    }
    if (taken) ++wrong;
    for (Simulation* simulation : {&told, &untold}) laboratory.advance(*simulation, 0.1);
  }
  const StrandState after = told.state(), truth = untold.state();
  for (size_t v = 0; v < truth.positions.size(); ++v)
    if (after.positions[v] != truth.positions[v] || after.velocities[v] != truth.velocities[v]) ++wrong;
  return {absoluteCase({kRefused, "inputs of 7 taken, vertices that move otherwise", ""}, wrong, 0, 0)};
}

// One strand gets NaN positions, another is moved far away; the third must not be affected.
constexpr const char *kResetCount = "strands that went wrong: counted",
                     *kResetPlace = "strands that went wrong: at the rest shape",
                     *kResetOthers = "strands that went wrong: others";

std::vector<Case> resets(const Laboratory& laboratory) {
  Simulation simulation = laboratory.simulation(
      modelOf({straightStrand(0.25, kEdges, Vec3::UnitX()), helixStrand(0.01, 0.01, 0.2, kEdges),
               straightStrand(0.2, kEdges, Vec3::UnitZ())}),
      laboratory.parameters(kRate, kStressDrag));
  const StrandState rest = simulation.state();
  laboratory.advance(simulation, 1);
  const std::vector<uint32_t>& offsets = simulation.model().offsets;
  StrandState state = simulation.state();
  state.positions[offsets[0] + 5].x() = std::numeric_limits<float>::quiet_NaN();
  state.positions[offsets[2] - 1] += Vec3(5, 0, 0);
  simulation.backend().upload(state);
  const double count = static_cast<double>(simulation.resetDiverged());
  const StrandState after = simulation.state();
  double off = 0, changed = 0;
  for (size_t v = 0; v < offsets[2]; ++v)
    off = worse(off, 1e3 * (after.positions[v] - rest.positions[v]).cast<double>().norm());
  for (size_t v = offsets[2]; v < offsets[3]; ++v)
    changed = worse(changed, 1e3 * (after.positions[v] - state.positions[v]).cast<double>().norm());
  return {absoluteCase({kResetCount, "strands reset", ""}, count, 2, 0),
          absoluteCase({kResetPlace, "largest distance of a vertex", "mm"}, off, 0, 1e-3),
          absoluteCase({kResetOthers, "largest distance of a vertex", "mm"}, changed, 0, 0)};
}

}  // namespace

void addGuardExperiments(std::vector<Experiment>& experiments) {
  auto add = [&](const std::string& about, const std::string& name, auto run) {
    experiments.push_back({about, {name + ": finite", name + ": returns"}, run});
  };
  add("strands of 1000 times the stiffness of hair, shaken", "1000 times the stiffness", stiff);
  add("the root leaps by 1 m in one step, and back", "leap of 1 m", leap);
  for (const int rate : kConstantRates)
    add(fmt::format("steps of 1/{} s all the time, shaken", rate), nameOfRate(rate),
        [rate](const Laboratory& laboratory) { return constantStep(laboratory, rate); });
  add("64 substeps of steps of 1/30 s all the time, shaken", "64 substeps", maxSubsteps);
  add("64 substeps of steps of 1/2000 s all the time, shaken", "64 substeps of 1/2000 s", shortestSubsteps);
  add("time steps of 1/30 to 1/2000 s by turns, shaken", "changing time steps", timeSteps);
  add("1 to 64 substeps of steps of 1/60 s by turns, shaken", "changing substeps", substeps);
  add("internal damping of 0.1 s, shaken", "internal damping of 0.1 s", dampedShake);
  add("ten vertices in one point, then all of them", "coincident vertices", coincident);
  experiments.push_back(
      {"100 strands of any shape, up to 1000 times as stiff as hair, shaken and carried away",
       {kThrown},
       thrown});
  experiments.push_back({"strands of 64 and 96 vertices with a kink in every joint, let go",
                         {kKinked},
                         [](const Laboratory& laboratory) { return kinked(laboratory, kKinked, {}); }});
  experiments.push_back({"the same beside a ball that none of them touches",
                         {kKinkedBesideABall},
                         [](const Laboratory& laboratory) {
                           const Vec3 place(0.02f, -0.04f, 0);
                           const ContactPrimitive ball{PrimitiveKind::kSphere, place, place, 0.001f};
                           return kinked(laboratory, kKinkedBesideABall, {{{ball}, false}});
                         }});
  experiments.push_back({"32 strands of 25 to 49 vertices with kinks of 7 to 30 degrees, let go",
                         {kKinkedFromEdgeToEdge},
                         kinkedFromEdgeToEdge});
  experiments.push_back({"24 level strands with one edge of an eighth to a third of the others, let go",
                         {kCutUnevenly},
                         cutUnevenly});
  experiments.push_back({"a strand in wind that pulls at it 30 times as hard as gravity",
                         {kStrongWind, kStrongWindTension},
                         strongWind});
  experiments.push_back(
      {"4 strands of 61 vertices pinned at both ends, longer than the way between by the part slack",
       namesOfSlack(), nearlyTaut});
  experiments.push_back(
      {"16 strands of 61 vertices pinned at both ends, 1/2000 longer than the way between, shaken",
       {kTautStretch, kTautRest},
       tautBetweenPins});
  experiments.push_back({"16 strands 1 km from the origin on two axes, shaken for 1 s and left alone for 4",
                         {kFarStretch, kFarSpeed},
                         farAway});
  experiments.push_back(
      {"poses, parameters and a body that are not finite, between steps", {kRefused}, refused});
  experiments.push_back({"one strand of three is given a place that is no number, another one 5 m away",
                         {kResetCount, kResetPlace, kResetOthers},
                         resets});
}

}  // namespace strandcast
