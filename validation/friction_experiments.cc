#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/smooth_step.h"
#include "validation/experiments.h"
#include "validation/rest_shapes.h"
#include "validation/shooting.h"
#include "validation/specimen.h"

namespace strandcast {
namespace {

// Step rates for forces of many times the weight of hair. At lower rates such tensions make strands vibrate.
constexpr double kPressedRate =
    1440;  // for stick-slip; at half of it rods shortened by a third slip 5 % too early
constexpr double kTautRate = 720;      // for capstan
constexpr double kHairRadius = 40e-6;  // m, radius of the hair

// Strands of one shape with friction coefficients low, low + step, ...; the body has friction 1.
struct Frictions {
  double low, step;
  int count;
  double of(size_t s) const { return low + step * static_cast<double>(s); }
};
StrandModel modelOfFrictions(const StrandPoints& points, const Material& material, const Frictions& range) {
  std::vector<Material> materials(range.count, material);
  for (size_t s = 0; s < materials.size(); ++s) materials[s].friction_scale = static_cast<float>(range.of(s));
  return modelOf(std::vector<StrandPoints>(range.count, points), materials);
}

// Friction at the transition from slipping to sticking: the mean of the largest friction that slips and the
// smallest that sticks. NaN where all strands slip or all stick.
template <class Slips>
double threshold(const Frictions& range, const Slips& slips) {
  double slipping = -1, stuck = -1;
  for (int s = 0; s < range.count; ++s) {
    if (slips(s))
      slipping = range.of(s);
    else if (stuck < 0)
      stuck = range.of(s);
  }
  return slipping < 0 || stuck < 0 ? std::nan("") : (slipping + stuck) / 2;
}

Parameters parametersWith(const Laboratory& laboratory, double air_drag, const Vec3& gravity,
                          double rate = kRate) {
  Parameters parameters = laboratory.parameters(rate, air_drag);
  parameters.gravity = gravity;
  parameters.hair_radius = static_cast<float>(kHairRadius);
  return parameters;
}

// Stick-slip of tips.

constexpr double kPressed[] = {0.02801, 0.06013, 0.10302, 0.21471, 0.33001};

std::vector<std::string> namesOfStickSlip() { return caseNames("stick-slip shortening={:g}", kPressed); }

// Presses upright rods slowly against a plane, starting slightly bent with the tip below the clamp. Returns
// the largest displacement of each tip so far, as a fraction of the length, by friction.
std::vector<double> tipDisplacements(const Laboratory& laboratory, double shortening,
                                     const Frictions& range) {
  constexpr double kLength = 0.1, kFirst = 0.01, kSpeed = 0.005;  // m, fraction, m/s
  constexpr double kResting = 1;                                  // s
  const float floor = static_cast<float>((kFirst - 1) * kLength - kHairRadius);
  Simulation simulation =
      laboratory.simulation(modelOfFrictions(straightStrand(kLength, kEdges, -Vec3::UnitY()), {}, range),
                            {{{{PrimitiveKind::kPlane, Vec3(0, floor, 0), Vec3::UnitY(), 0, 1}}, false}},
                            parametersWith(laboratory, 5, Vec3::Zero(), kPressedRate));
  const PressedElastica first = pressedElastica(kFirst, kEdges);
  const std::vector<Vec2>& shape = first.shape;
  const double unit = bendingOverMass(Material{}) * kEdges / std::pow(kLength, 3);  // m/s^2, unit of forces
  const Vec3 force = Eigen::Vector3d(first.side * unit, first.press * unit, 0).cast<float>();
  StrandState state = simulation.state();
  for (size_t v = 0; v < state.positions.size(); ++v) {
    const size_t i = v % shape.size();
    state.positions[v] = static_cast<float>(kLength) * Vec3(shape[i].x(), -shape[i].y(), 0);
    if (i == 0) continue;
    const Vec3 tangent = (state.positions[v] - state.positions[v - 1]).normalized();
    state.frames[v - 1] = shortestRotation<float>(-Vec3::UnitY(), tangent) * state.frames[v - 1];
    state.tensions[v - 1] = force.dot(tangent);
    if (i == kEdges) state.contacts[v] = force;
  }
  simulation.backend().upload(state);
  const double duration = (shortening - kFirst) * kLength / kSpeed;
  std::vector<double> farthest(range.count, 0.0);  // m, largest displacement per tip
  laboratory.advance(
      simulation, 2 * duration + kResting,
      [&](double t) {
        const double way = kSpeed * duration * smoothStep(t / (2 * duration));
        return Pose{Vec3(0, static_cast<float>(-way), 0), Quat::Identity()};
      },
      [&] {
        for (size_t s = 0; s < farthest.size(); ++s)
          farthest[s] = std::max(farthest[s], std::fabs(static_cast<double>(tipOf(simulation, s).x())));
      });
  for (double& way : farthest) way /= kLength;
  return farthest;
}

constexpr double kSlipped = 0.02;  // fraction of the length: a tip displaced by more has slipped

double slipThreshold(const Laboratory& laboratory, double shortening, double truth) {
  const Frictions range{0.88 * truth, 0.008 * truth, 31};
  const std::vector<double> ways = tipDisplacements(laboratory, shortening, range);
  return threshold(range, [&](int s) { return ways[static_cast<size_t>(s)] > kSlipped; });
}

std::vector<Case> stickSlip(const Laboratory& laboratory) {
  std::vector<Case> cases;
  for (size_t i = 0; i < std::size(kPressed); ++i) {
    const double truth = pressedElastica(kPressed[i], 1).friction();
    cases.push_back(relativeCase({namesOfStickSlip()[i], "friction below which the tip slips", ""},
                                 slipThreshold(laboratory, kPressed[i], truth), truth, 3));
  }
  return cases;
}

// This friction exceeds what any shortening needs, so the tip must stick until the rod's end lies on the
// plane. That is at the last of kPressed.
constexpr double kStickingFriction = 0.4;
const std::string kSticking = "stick-slip friction=0.4";

std::vector<Case> sticking(const Laboratory& laboratory) {
  const double most =
      tipDisplacements(laboratory, kPressed[std::size(kPressed) - 1], {kStickingFriction, 0, 1})[0];
  return {absoluteCase({kSticking, "farthest way of the tip before line contact, % of the length", "%"},
                       100 * most, 0, 100 * kSlipped)};
}

// Slopes.

constexpr double kSlopes[] = {10, 30, 50};  // degrees
constexpr double kSlopeLength = 0.25;       // m

std::vector<std::string> namesOfSlope(const char* what) {
  return caseNames(fmt::format("slope angle={{:g}} {}", what), kSlopes);
}

// A limp strand lies across a slope that falls towards X. Its root is fixed, which does not affect the rest
// of the strand for a while.
Simulation strandsOnSlope(const Laboratory& laboratory, double angle, const Frictions& range) {
  Material limp;
  limp.youngs_modulus = 1e3f;
  const Vec3 normal(static_cast<float>(std::sin(angle)), static_cast<float>(std::cos(angle)), 0);
  return laboratory.simulation(
      modelOfFrictions(straightStrand(kSlopeLength, kEdges, Vec3::UnitZ()), limp, range),
      {{{{PrimitiveKind::kPlane, normal * static_cast<float>(-kHairRadius), normal, 0, 1}}, false}},
      parametersWith(laboratory, 0, Vec3(0, -kGravity, 0)));
}

double slid(Simulation& simulation, size_t s) {
  const std::span<const Vec3> strand = strandOf(simulation, s);
  return (strand[3 * kEdges / 4] - Vec3(0, 0, static_cast<float>(kSlopeLength * 3 / 4)))
      .cast<double>()
      .norm();
}

std::vector<Case> slopeThreshold(const Laboratory& laboratory) {
  std::vector<Case> cases;
  for (size_t i = 0; i < std::size(kSlopes); ++i) {
    const double angle = kSlopes[i] * std::numbers::pi / 180, truth = std::tan(angle);
    const Frictions range{0.9 * truth, 0.005 * truth, 41};
    Simulation simulation = strandsOnSlope(laboratory, angle, range);
    laboratory.advance(simulation, 1);
    const double found = threshold(range, [&](int s) { return slid(simulation, s) > 1e-4; });
    cases.push_back(relativeCase({namesOfSlope("threshold")[i], "friction below which the strand slides", ""},
                                 found, truth, 3));
  }
  return cases;
}

std::vector<Case> slopeSliding(const Laboratory& laboratory) {
  std::vector<Case> cases;
  for (size_t i = 0; i < std::size(kSlopes); ++i) {
    constexpr double kFirst = 0.01, kWay = 0.005;  // s; m, largest displacement
    const double angle = kSlopes[i] * std::numbers::pi / 180;
    const double friction = std::tan(angle) / 2;
    const double truth = kGravity * (std::sin(angle) - friction * std::cos(angle));
    Simulation simulation = strandsOnSlope(laboratory, angle, {friction, 0, 1});
    laboratory.advance(simulation, kFirst);
    const double t0 = simulation.time(), x0 = slid(simulation, 0);
    laboratory.advance(simulation, std::sqrt(2 * kWay / truth) - kFirst);
    // A substep moves by the velocity at its end, so its time is half a substep later.
    const double half = 0.5 / kRate, t1 = simulation.time(), x1 = slid(simulation, 0);
    const double measured = 2 * (x1 - x0) / ((t1 + half) * (t1 + half) - (t0 + half) * (t0 + half));
    cases.push_back(
        relativeCase({namesOfSlope("sliding")[i], "acceleration, m/s^2", ""}, measured, truth, 3));
  }
  return cases;
}

// A strand across the slope with 5 % more friction than needed: its creep after it has settled.
std::vector<Case> slopeCreep(const Laboratory& laboratory) {
  std::vector<Case> cases;
  for (size_t i = 0; i < std::size(kSlopes); ++i) {
    const double angle = kSlopes[i] * std::numbers::pi / 180;
    Simulation simulation = strandsOnSlope(laboratory, angle, {1.05 * std::tan(angle), 0, 1});
    laboratory.advance(simulation, 0.5);
    const std::span<const Vec3> now = strandOf(simulation, 0);
    const std::vector<Vec3> before(now.begin(), now.end());
    laboratory.advance(simulation, 3);
    double moved = 0;
    for (size_t v = 0; v < before.size(); ++v)
      moved = worse(moved, 1e3 * (strandOf(simulation, 0)[v] - before[v]).cast<double>().norm());
    cases.push_back(absoluteCase({namesOfSlope("creep")[i], "largest distance of a vertex in 3 s", "mm"},
                                 moved, 0, 0.01));
  }
  return cases;
}

// Capstan.

constexpr double kCapstanFrictions[] = {0.1, 0.3, 0.6};

std::vector<std::string> namesOfCapstan() { return caseNames("capstan friction={:g}", kCapstanFrictions); }

// Ratio of the tensions at the upper and the lower end of a heavy string that slides over a quarter of a
// cylinder, from its side to its top: dT/dphi = friction (T + w r sin phi) + w r cos phi, phi from the side.
// `weight`: w r over the lower tension. Without weight the ratio is exp(friction pi / 2).
double capstanRatio(double friction, double weight) {
  constexpr int kSteps = 1000;
  constexpr double kQuarter = std::numbers::pi / 2;
  double tension = 1;
  for (int i = 0; i < kSteps; ++i)
    tension = rungeKuttaStep(kQuarter * i / kSteps, tension, kQuarter / kSteps, [&](double at, double t) {
      return friction * (t + weight * std::sin(at)) + weight * std::cos(at);
    });
  return tension;
}

// A limp strand over a horizontal cylinder. The root is pulled horizontally; the tip carries a load.
std::vector<Case> capstan(const Laboratory& laboratory) {
  constexpr double kCylinder = 0.04, kHanging = 0.1, kLevel = 0.06;  // m
  constexpr double kSpeed = 0.02, kPulling = 2;                      // m/s, s
  constexpr double kLoad = 5;                                        // load over the weight of the strand
  const double arc = kCylinder * std::numbers::pi / 2, length = kLevel + arc + kHanging;
  const double out = kCylinder + kHairRadius;
  StrandPoints points;
  for (int i = 0; i <= kEdges; ++i) {
    const double at = length * i / kEdges, on = (at - kLevel) / kCylinder;
    if (at < kLevel)
      points.emplace_back(at, 0, 0);
    else if (at < kLevel + arc)
      points.emplace_back(kLevel + out * std::sin(on), out * (std::cos(on) - 1), 0);
    else
      points.emplace_back(kLevel + out, -out - (at - kLevel - arc), 0);
  }
  Material limp;
  limp.youngs_modulus = 1e3f;
  std::vector<Material> materials;
  for (const double friction : kCapstanFrictions) {
    materials.push_back(limp);
    materials.back().friction_scale = static_cast<float>(friction);
  }
  StrandModel model = modelOf(std::vector<StrandPoints>(materials.size(), points), materials);
  for (size_t s = 0; s < materials.size(); ++s)
    model.mass[model.offsets[s + 1] - 1] += static_cast<float>(kLoad * kEdges);
  const Vec3 axis(static_cast<float>(kLevel), static_cast<float>(-out), 0), reach(0, 0, 1);
  Simulation simulation = laboratory.simulation(
      std::move(model),
      {{{{PrimitiveKind::kCapsule, axis - reach, axis + reach, static_cast<float>(kCylinder), 1}}, false}},
      parametersWith(laboratory, 5, Vec3(0, -kGravity, 0), kTautRate));
  laboratory.advance(simulation, kPulling,
                     [&](double t) {
                       return Pose{Vec3(static_cast<float>(-kSpeed * t), 0, 0), Quat::Identity()};
                     },
                     {});
  const StrandState state = simulation.state();
  std::vector<Case> cases;
  for (size_t s = 0; s < materials.size(); ++s) {
    const std::span<const float> tensions(state.tensions.data() + simulation.model().offsets[s], kEdges);
    // The part that still hangs at the end of the pull counts as load.
    const double lower = kLoad + (kHanging - kSpeed * kPulling) / length;
    const double truth = capstanRatio(kCapstanFrictions[s], out / length / lower);
    const double load = kLoad * kEdges * kGravity;  // over reference mass
    cases.push_back(relativeCase({namesOfCapstan()[s], "tension at the root over load", ""},
                                 tensions.front() / (load * lower / kLoad), truth, 3));
  }
  return cases;
}

}  // namespace

void addFrictionExperiments(std::vector<Experiment>& experiments) {
  experiments.push_back(
      {"upright rods pressed on a plane, tip first, until they slip", namesOfStickSlip(), stickSlip});
  experiments.push_back({"an upright rod pressed on a plane that its tip sticks to", {kSticking}, sticking});
  experiments.push_back(
      {"limp strands of many frictions across a slope", namesOfSlope("threshold"), slopeThreshold});
  experiments.push_back({"a limp strand across a slope with half the friction that would hold it",
                         namesOfSlope("sliding"), slopeSliding});
  experiments.push_back({"a limp strand across a slope with 5 % more friction than holds it",
                         namesOfSlope("creep"), slopeCreep});
  experiments.push_back(
      {"a limp strand pulled over a level cylinder, a load of five times its weight on its tip",
       namesOfCapstan(), capstan});
}

}  // namespace strandcast
