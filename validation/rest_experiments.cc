#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "core/sag_free.h"
#include "validation/experiments.h"
#include "validation/rest_shapes.h"
#include "validation/specimen.h"

namespace strandcast {
namespace {

constexpr double kRestTime = 10;  // s

constexpr double kTipLoads[] = {1, 5, 10};  // alpha = P L^2 / B
constexpr double kTipToStrand = 5;          // weight of the load over that of the strand

std::vector<std::string> namesOfTipLoad() { return caseNames("tip load alpha={:g}", kTipLoads); }

// The load is a heavy last vertex. The exact solution includes the strand's own weight. Gravity is weak, so
// the strand may be long; a short one is too stiff for the time step.
std::vector<Case> tipLoad(const Laboratory& laboratory) {
  constexpr double kLength = 0.07;  // m
  std::vector<Case> cases;
  std::vector<StrandPoints> strands;
  std::vector<Material> materials;
  for (const double alpha : kTipLoads) {
    strands.push_back(straightStrand(kLength, kEdges, Vec3::UnitX()));
    materials.emplace_back();
    materials.back().youngs_modulus /= static_cast<float>(alpha);
  }
  StrandModel model = modelOf(strands, materials);
  for (size_t s = 0; s < strands.size(); ++s) model.mass[model.offsets[s + 1] - 1] += kTipToStrand * kEdges;
  Parameters parameters = laboratory.parameters(kRate, 5);
  parameters.gravity.y() =
      static_cast<float>(-bendingOverMass(Material{}) / (kTipToStrand * std::pow(kLength, 3)));
  Simulation simulation = laboratory.simulation(std::move(model), parameters);
  laboratory.advance(simulation, 12);
  for (size_t s = 0; s < strands.size(); ++s) {
    const double truth = restingElastica(kTipLoads[s] / kTipToStrand, kTipLoads[s]).drop;
    cases.push_back(relativeCase({namesOfTipLoad()[s], "tip drop/L", ""}, -tipOf(simulation, s).y() / kLength,
                                 truth, 0.5));
  }
  return cases;
}

constexpr double kSpans[] = {0.2, 0.5, 0.8, 0.9999};

std::vector<std::string> namesOfCatenary() { return caseNames("catenary span={:g}", kSpans); }

std::vector<Case> catenary(const Laboratory& laboratory) {
  constexpr float kLength = 0.25f;
  Material limp;
  limp.youngs_modulus = 1e3f;
  StrandSet set;
  for (const double span : kSpans) {  // initially two straight halves that meet below
    const Vec3 middle =
        Vec3(static_cast<float>(span), -static_cast<float>(std::sqrt(1 - span * span)), 0) * kLength / 2;
    StrandPoints points;
    for (int i = 0; i <= kEdges; ++i) {
      const float along = 2.0f * static_cast<float>(std::min(i, kEdges - i)) / kEdges;
      Vec3 point = middle * along;
      if (2 * i > kEdges) point.x() = 2 * middle.x() - point.x();
      points.push_back(point);
    }
    set.append(points);
    set.pinned.resize(set.vertices(), 0);
    set.pinned.back() = 1;
  }
  Simulation simulation =
      laboratory.simulation(makeStrandModel(set, {limp}), laboratory.parameters(kRate, 5));
  laboratory.advance(simulation, kRestTime);
  std::vector<Case> cases;
  for (size_t s = 0; s < std::size(kSpans); ++s) {
    const double sag = -strandOf(simulation, s)[kEdges / 2].y() / kLength;
    cases.push_back(relativeCase({namesOfCatenary()[s], "sag/L", ""}, sag, catenarySag(kSpans[s]), 0.5));
  }
  return cases;
}

std::vector<Case> hungHelix(const Laboratory& laboratory) {
  constexpr double kRadius = 0.01, kPitch = 0.01, kLength = 0.2;  // m
  const double rise = kPitch / (2 * std::numbers::pi), square = kRadius * kRadius + rise * rise;
  HungRod rod;
  rod.gamma = kGravity * std::pow(kLength, 3) / bendingOverMass(Material{});
  rod.curvature = kLength * kRadius / square;
  rod.torsion = kLength * rise / square;
  rod.down = Eigen::Vector3d(0, kRadius, rise) / std::sqrt(square);
  const double truth = 1e3 * kLength * hangingDepth(rod);
  Simulation simulation = laboratory.simulation(modelOf({helixStrand(kRadius, kPitch, kLength, kEdges)}),
                                                laboratory.parameters(kRate, 5));
  laboratory.advance(simulation, kRestTime);
  return {relativeCase({"hung helix", "height", "mm"}, -1e3 * tipOf(simulation, 0).y(), truth, 3)};
}

// Sag-free grooms of shapes that hair cannot hold by itself: largest displacement of a vertex under gravity.
std::vector<Case> sagFree(const Laboratory& laboratory) {
  StrandModel model =
      modelOf({straightStrand(0.1, kEdges, Vec3::UnitX()), straightStrand(0.08, kEdges, Vec3::UnitY()),
               helixStrand(0.01, 0.01, 0.2, kEdges), arcStrand(20, 0.15, kEdges)});
  const Parameters parameters = laboratory.parameters(kRate, 2);
  const SagFreeReport report = makeSagFree(model, parameters.gravity);
  Simulation simulation = laboratory.simulation(std::move(model), parameters);
  const StrandState groomed = simulation.state();
  double drift = 0;
  laboratory.advance(simulation, 3, [&] {
    const std::span<const Vec3> now = simulation.guides();
    for (size_t v = 0; v < now.size(); ++v)
      drift = worse(drift, 1e3 * (now[v] - groomed.positions[v]).cast<double>().norm());
  });
  Case found = absoluteCase({"sag-free drift", "largest distance of a vertex", "mm"}, drift, 0, 0.1);
  found.note = fmt::format("{} of 4 strands stiffened, by up to {:.1f}", report.stiffened.size(),
                           report.largest_factor);
  return {found};
}

// Largest rms speed of a strand some time after a push, mm/s.
double restSpeedAfterPush(const Laboratory& laboratory, StrandModel model, const Parameters& parameters) {
  constexpr double kSettling = 10;  // s
  Simulation simulation = laboratory.simulation(std::move(model), parameters);
  StrandState state = simulation.state();
  for (Vec3& velocity : state.velocities) velocity += Vec3(0.01f, 0.003f, -0.02f);
  simulation.backend().upload(state);
  laboratory.advance(simulation, kSettling);
  return 1e3 * fastestOf(simulation);
}

// Helices fall from their natural shape. Joints turn by at most 60 degrees.
std::vector<Case> helices(const Laboratory& laboratory) {
  std::vector<StrandPoints> strands;
  for (const double radius : {0.005, 0.01, 0.02})
    for (const double pitch : {0.01, 0.03})
      for (const double length : {0.15, 0.3})
        for (const int edges : {31, 63}) {
          const double turn =
              2 * std::numbers::pi * length / std::hypot(2 * std::numbers::pi * radius, pitch);
          if (turn / edges < std::numbers::pi / 3)
            strands.push_back(helixStrand(radius, pitch, length, edges));
        }
  return {absoluteCase(
      {"helices come to rest", "largest rms speed of a strand", "mm/s"},
      restSpeedAfterPush(laboratory, modelOf(strands, Material{}), laboratory.parameters(kRate, 2)), 0, 1)};
}

// Waves that leave their root obliquely and then hang. Rest moments hold their shape; internal damping must
// not turn these into a drive.
constexpr double kDampingTimes[] = {0.02, 0.1};  // s

std::vector<std::string> namesOfDamped() { return caseNames("damped by {:g} s: at rest", kDampingTimes); }

std::vector<Case> damped(const Laboratory& laboratory) {
  constexpr int kStrands = 24;
  constexpr double kRadius = 0.005, kPitch = 0.065, kLength = 0.29, kBow = 0.03;  // m
  std::vector<StrandPoints> strands;
  for (int s = 0; s < kStrands; ++s) {
    const Quat turn(
        Eigen::AngleAxisf(2 * std::numbers::pi_v<float> * static_cast<float>(s) / kStrands, Vec3::UnitY()));
    strands.push_back(helixStrand(kRadius, kPitch, kLength, 27));
    for (Vec3& point : strands.back()) {
      const auto out = static_cast<float>(kBow * (1 - std::exp(point.y() / kBow)));
      point = turn * point + Vec3(0, 0, out);
    }
  }
  std::vector<Case> cases;
  for (size_t i = 0; i < std::size(kDampingTimes); ++i) {
    Parameters parameters = laboratory.parameters(kRate, 1);
    parameters.damping_time = static_cast<float>(kDampingTimes[i]);
    StrandModel model = modelOf(strands, Material{});
    makeSagFree(model, parameters.gravity);
    cases.push_back(absoluteCase({namesOfDamped()[i], "largest rms speed of a strand", "mm/s"},
                                 restSpeedAfterPush(laboratory, std::move(model), parameters), 0, 1));
  }
  return cases;
}

// Hair that grows upwards hangs down over its root. With a tenth of the stiffness of human hair, as fur and
// wool have, its first joint turns by more than 100 degrees.
constexpr double kSubstepsFolded[] = {4, 6};

std::vector<std::string> namesOfFolded() {
  return caseNames("folded over its root, {:g} substeps: at rest", kSubstepsFolded);
}

std::vector<Case> foldedOverRoot(const Laboratory& laboratory) {
  constexpr float kLength = 0.4f;  // m
  Material soft;
  soft.youngs_modulus /= 10;
  std::vector<StrandPoints> strands;
  for (const float lean : {5.0f, 10.0f, 20.0f, 30.0f, 45.0f}) {  // degrees
    const float angle = lean * std::numbers::pi_v<float> / 180;
    strands.push_back(straightStrand(kLength, kEdges, Vec3(std::sin(angle), std::cos(angle), 0)));
  }
  std::vector<Case> cases;
  for (size_t i = 0; i < std::size(kSubstepsFolded); ++i) {
    Parameters parameters = laboratory.parameters(60, 5);
    parameters.substeps = static_cast<int>(kSubstepsFolded[i]);
    cases.push_back(absoluteCase({namesOfFolded()[i], "largest rms speed of a strand", "mm/s"},
                                 restSpeedAfterPush(laboratory, modelOf(strands, soft), parameters), 0, 1));
  }
  return cases;
}

}  // namespace

void addRestExperiments(std::vector<Experiment>& experiments) {
  experiments.push_back({"horizontal strands with a load at the tip", namesOfTipLoad(), tipLoad});
  experiments.push_back({"limp strands between two points of equal height", namesOfCatenary(), catenary});
  experiments.push_back(
      {"a helix of radius 1 cm, pitch 1 cm and length 20 cm hung by its root", {"hung helix"}, hungHelix});
  experiments.push_back(
      {"helices of radius 5 to 20 mm, pitch 10 and 30 mm, 15 and 30 cm long, 10 s after they were let go",
       {"helices come to rest"},
       helices});
  experiments.push_back(
      {"waves made to rest as groomed, with internal damping, 10 s after a push", namesOfDamped(), damped});
  experiments.push_back({"upright strands of 40 cm, a tenth as stiff as hair, 10 s after a push",
                         namesOfFolded(), foldedOverRoot});
  experiments.push_back({"strands made to rest as groomed (core/sag_free.h): level, upright, helix, arc",
                         {"sag-free drift"},
                         sagFree});
}

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
std::vector<Case> bendTwistCases(const Laboratory& laboratory) {
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
      {"naturally curved strands hang in their plane or leave it", namesOfThreshold(), bendTwistCases});
  experiments.push_back({"the root of a hanging strand turns about its axis",
                         {"root twist angle=90", "root twist angle=720"},
                         twist});
}

}  // namespace strandcast
