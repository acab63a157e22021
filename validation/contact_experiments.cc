#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "collision/field_bake.h"
#include "core/rod_elasticity.h"
#include "validation/experiments.h"
#include "validation/specimen.h"

namespace strandcast {
namespace {

constexpr double kPi = std::numbers::pi;

// Steps as in the programs: 1/60 s, four substeps.
Parameters frames(const Laboratory& laboratory, double air_drag) {
  Parameters parameters = laboratory.parameters(60, air_drag);
  parameters.substeps = 4;
  return parameters;
}

// Largest penetration of the hair's surface into a shape, m, at vertices and at points between them. Negative
// for hair that does not touch.
struct Depths {
  double vertices = -std::numeric_limits<double>::infinity(), segments = vertices;

  void see(std::span<const Vec3> strand, const MovingPrimitive& shape, std::span<const uint32_t> words,
           double hair_radius) {
    constexpr int kBetween = 7;
    auto depth = [&](const Vec3& point) {  // NaN for NaN: a field returns a distance for it
      return point.allFinite() ? hair_radius - signedDistance(shape, point, words) : std::nan("");
    };
    for (size_t i = 1; i < strand.size(); ++i) {
      vertices = worse(vertices, depth(strand[i]));
      for (int k = 1; k <= kBetween; ++k)
        segments = worse(segments, depth(strand[i - 1] + (strand[i] - strand[i - 1]) *
                                                             (static_cast<float>(k) / (kBetween + 1))));
    }
  }
};

// A shape at the pose of its body at the end of a step.
class SeenShape {
 public:
  explicit SeenShape(const ContactPrimitive& shape) : shape_(shape), data_(words_.add(shape)) {}
  void see(Simulation& simulation, const Pose& pose, Depths& depths) const {
    const Parameters& p = simulation.parameters();
    const MovingPrimitive placed = moved(shape_, pose, pose, p.time_step, data_);
    for (size_t s = 0; s < simulation.model().strands(); ++s)
      depths.see(strandOf(simulation, s), placed, words_.words, p.hair_radius);
  }

 private:
  ContactPrimitive shape_;
  ShapeData words_;
  uint32_t data_;
};

// Dropped hair: horizontal strands with their roots above the shape, one alone and a tuft of 24.
std::vector<StrandPoints> droppedStrands(const Vec3& root) {
  std::vector<StrandPoints> strands;
  for (int s = 0; s < 25; ++s) {
    const double angle = s == 0 ? 0 : 0.02 * (s - 12);
    const Vec3 along(static_cast<float>(std::cos(angle)), 0, static_cast<float>(std::sin(angle)));
    const Vec3 from = root + Vec3(0, 0, s == 0 ? 0 : 0.0005f * static_cast<float>(s - 12));
    strands.push_back(straightStrand(kHairLength, kEdges, along));
    for (Vec3& point : strands.back()) point += from;
  }
  return strands;
}

struct Drop {
  std::string name;
  std::function<ContactPrimitive()> shape;
  Vec3 root;
};

constexpr float kBall = 0.1f;  // m

ContactPrimitive ballShape() { return {PrimitiveKind::kSphere, Vec3::Zero(), Vec3::UnitY(), kBall}; }

ContactPrimitive turnedShape(PrimitiveKind kind, const Vec3& extent) {
  ContactPrimitive shape{kind, Vec3::Zero(), Vec3::UnitY(), 0};
  shape.extent = extent;
  shape.rotation = Quat(Eigen::AngleAxisf(0.2f, Eigen::Vector3f::UnitZ()));
  return shape;
}

// A truncated pyramid; the hair comes to lie on its top.
ContactPrimitive pyramidShape() {
  TriangleMesh mesh;
  for (const float y : {-0.05f, 0.05f})
    for (const auto& [x, z] : {std::pair(-1, -1), {1, -1}, {1, 1}, {-1, 1}})
      mesh.positions.push_back(
          Vec3(static_cast<float>(x) * (0.35f - y), y, static_cast<float>(z) * (0.25f - y)));
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 6, 5}, {4, 7, 6}};
  for (uint32_t i = 0; i < 4; ++i) {
    const uint32_t next = (i + 1) % 4;
    mesh.triangles.push_back({i, i + 4, next});
    mesh.triangles.push_back({next, i + 4, next + 4});
  }
  ContactPrimitive shape = turnedShape(PrimitiveKind::kConvex, Vec3::Zero());
  shape.convex = std::make_shared<ConvexBody>(convexBody(mesh));
  return shape;
}

// A mesh of 36,480 triangles with the shape of an ellipsoid, as a distance field with cells of 2 mm.
ContactPrimitive meshShape() {
  constexpr uint32_t kRound = 192, kUp = 96;
  TriangleMesh mesh;
  mesh.positions.push_back(Vec3(0, 1, 0));
  for (uint32_t j = 1; j < kUp; ++j)
    for (uint32_t i = 0; i < kRound; ++i) {
      const double up = kPi * j / kUp, turn = 2 * kPi * i / kRound;
      mesh.positions.push_back(
          Eigen::Vector3d(std::sin(up) * std::sin(turn), std::cos(up), std::sin(up) * std::cos(turn))
              .cast<float>());
    }
  mesh.positions.push_back(Vec3(0, -1, 0));
  const auto last = static_cast<uint32_t>(mesh.positions.size() - 1);
  for (uint32_t i = 0; i < kRound; ++i) {
    const uint32_t next = (i + 1) % kRound, bottom = last - kRound;
    mesh.triangles.push_back({0, 1 + i, 1 + next});
    mesh.triangles.push_back({last, bottom + next, bottom + i});
    for (uint32_t j = 0; j + 2 < kUp; ++j) {
      const uint32_t row = 1 + j * kRound, below = row + kRound;
      mesh.triangles.push_back({row + i, below + i, below + next});
      mesh.triangles.push_back({row + i, below + next, row + next});
    }
  }
  for (Vec3& position : mesh.positions) position = position.cwiseProduct(Vec3(0.12f, 0.1f, 0.15f));
  FieldOptions options;
  options.cell = 0.002f;
  ContactPrimitive shape = turnedShape(PrimitiveKind::kField, Vec3::Zero());
  shape.field = std::make_shared<DistanceField>(FieldBaker(mesh, options).bake());
  return shape;
}

const std::vector<Drop>& drops() {
  static const std::vector<Drop> list = {
      {"sphere", ballShape, Vec3(-0.07f, 0.13f, 0)},
      {"capsule",
       [] {
         return ContactPrimitive{PrimitiveKind::kCapsule, Vec3(0, 0, -0.2f), Vec3(0, 0, 0.2f), 0.09f};
       },
       Vec3(-0.07f, 0.12f, 0)},
      {"plane",
       [] {
         return ContactPrimitive{PrimitiveKind::kPlane, Vec3::Zero(), Vec3::UnitY(), 0};
       },
       Vec3(-0.05f, 0.03f, 0)},
      {"ellipsoid", [] { return turnedShape(PrimitiveKind::kEllipsoid, Vec3(0.12f, 0.1f, 0.15f)); },
       Vec3(-0.07f, 0.12f, 0)},
      {"box", [] { return turnedShape(PrimitiveKind::kBox, Vec3(0.3f, 0.05f, 0.2f)); },
       Vec3(-0.05f, 0.08f, 0)},
      {"convex body", pyramidShape, Vec3(-0.05f, 0.08f, 0)},
      {"mesh", meshShape, Vec3(-0.05f, 0.12f, 0)}};
  return list;
}

std::vector<std::string> namesOfDrops() {
  std::vector<std::string> names;
  for (const Drop& drop : drops())
    for (const char* what : {"vertices", "segments", "speed"})
      names.push_back(fmt::format("dropped on a {}: {}", drop.name, what));
  return names;
}

Simulation droppedHair(const Laboratory& laboratory, const Drop& drop, const ContactPrimitive& shape) {
  return laboratory.simulation(modelOf(droppedStrands(drop.root)), {{{shape}, false}}, frames(laboratory, 5));
}

std::vector<Case> droppedOn(const Laboratory& laboratory) {
  constexpr double kFalling = 3;  // s
  std::vector<Case> cases;
  for (const Drop& drop : drops()) {
    const ContactPrimitive shape = drop.shape();
    Simulation simulation = droppedHair(laboratory, drop, shape);
    laboratory.advance(simulation, kFalling);
    Depths depths;
    SeenShape(shape).see(simulation, {}, depths);
    const std::string name = "dropped on a " + drop.name + ": ";
    cases.push_back(
        absoluteCase({name + "vertices", "deepest after 3 s", "mm"}, 1e3 * depths.vertices, 0, 0.1));
    cases.push_back(absoluteCase({name + "segments", "deepest between vertices after 3 s", "mm"},
                                 1e3 * depths.segments, 0, 0.1));
    cases.push_back(absoluteCase({name + "speed", "largest rms speed of a strand after 3 s", "mm/s"},
                                 1e3 * fastestOf(simulation), 0, 1));
  }
  return cases;
}

std::vector<Case> motionCases(const std::string& name, const Depths& depths) {
  return {absoluteCase({name + ": vertices", "deepest", "mm"}, 1e3 * depths.vertices, 0, 1),
          absoluteCase({name + ": segments", "deepest between vertices", "mm"}, 1e3 * depths.segments, 0, 1)};
}

// The mesh tilts and slides under hair that lies on it.
std::vector<Case> rockingMesh(const Laboratory& laboratory) {
  constexpr double kFrequency = 2 * kPi, kLying = 1.5, kRocking = 3;  // rad/s, s
  constexpr double kTilt = 0.4, kWay = 0.05;                          // rad, m
  const Drop& drop = drops().back();
  const ContactPrimitive shape = drop.shape();
  const SeenShape seen(shape);
  Simulation simulation = droppedHair(laboratory, drop, shape);
  laboratory.advance(simulation, kLying);
  Depths depths;
  const double step = simulation.parameters().time_step;
  for (double t = step; t < kRocking; t += step) {
    const double part = (1 - std::cos(kFrequency * t)) / 2;
    const Pose pose{
        Vec3(static_cast<float>(kWay * part), 0, 0),
        Quat(Eigen::AngleAxisf(static_cast<float>(kTilt * part), Eigen::Vector3f(1, 0, 2).normalized()))};
    simulation.setBodyPose(0, pose);
    laboratory.advance(simulation, step);
    seen.see(simulation, pose, depths);
  }
  return motionCases("mesh tilted and moved", depths);
}

// Hair that stands out of a ball in all directions, kinked at every joint, falls on the ball and on a capsule
// below it.
constexpr const char* kKinkedPressed = "kinked, pressed by two bodies: speed";

std::vector<Case> kinkedPressed(const Laboratory& laboratory) {
  constexpr int kStrands = 32;
  constexpr double kSettling = 8;  // s
  std::mt19937 random(7);
  auto any = [&] { return anyNumber(random); };
  std::vector<StrandPoints> strands;
  for (int s = 0; s < kStrands; ++s) {
    const Vec3 out = Vec3(any(), std::abs(any()) + 0.1f, any()).normalized();
    const Vec3 direction = (out + 0.5f * Vec3(any(), any(), any())).normalized();
    strands.push_back(kinkedStrand((kBall + 5e-4f) * out, direction, s % 2 == 0 ? 0.15f : 0.25f,
                                   s % 2 == 0 ? 23 : 31, 0.3f, random));
  }
  const ContactPrimitive capsule{PrimitiveKind::kCapsule, Vec3(-0.2f, -0.17f, 0), Vec3(0.2f, -0.17f, 0),
                                 0.05f};
  Simulation simulation =
      laboratory.simulation(modelOf(strands), {{{ballShape(), capsule}, false}}, frames(laboratory, 5));
  laboratory.advance(simulation, kSettling);
  return {absoluteCase({kKinkedPressed, "largest rms speed of a strand after 8 s", "mm/s"},
                       1e3 * fastestOf(simulation), 0, 1)};
}

// Hair on a spherical head of radius 0.1 m.
StrandModel headOfHair() {
  std::vector<StrandPoints> strands;
  constexpr int kStrands = 200;
  for (int s = 0; s < kStrands; ++s) {  // Fibonacci spiral over the upper part
    const double up = 1 - 1.2 * (s + 0.5) / kStrands, turn = s * kPi * (3 - std::sqrt(5));
    const double across = std::sqrt(1 - up * up);
    const Vec3 out = Eigen::Vector3d(across * std::cos(turn), up, across * std::sin(turn)).cast<float>();
    strands.push_back(straightStrand(kHairLength, kEdges, out));
    for (Vec3& point : strands.back()) point += out * (kBall + 1e-4f);
  }
  return modelOf(strands);
}

// Shakes the head with 10 g at 2 Hz, starting from rest.
std::vector<Case> shakenHead(const Laboratory& laboratory) {
  constexpr double kFrequency = 2 * kPi * 2, kReach = 10 * kGravity / (kFrequency * kFrequency);
  constexpr double kSettling = 1.5, kShaking = 3;  // s
  const ContactPrimitive ball = ballShape();
  const SeenShape seen(ball);
  Simulation simulation = laboratory.simulation(headOfHair(), {{{ball}, true}}, frames(laboratory, 1));
  laboratory.advance(simulation, kSettling);
  Depths depths;
  laboratory.advance(
      simulation, kShaking,
      [&](double t) {
        return Pose{Vec3(static_cast<float>(kReach * (1 - std::cos(kFrequency * (t - kSettling)))), 0, 0),
                    Quat::Identity()};
      },
      [&] { seen.see(simulation, simulation.headPose(), depths); });
  return motionCases("head shaken by 10 g at 2 Hz", depths);
}

// A capsule as thick as an arm goes through the hair at 1 m/s, 1 cm above the scalp, and back.
std::vector<Case> sweptByHand(const Laboratory& laboratory) {
  constexpr double kSettling = 1.5, kWay = 0.4, kSpeed = 1;  // s, m, m/s
  constexpr float kHand = 0.04f;                             // m
  const ContactPrimitive ball = ballShape();
  const ContactPrimitive hand{PrimitiveKind::kCapsule, Vec3(0, 0, -0.15f), Vec3(0, 0, 0.15f), kHand};
  const SeenShape seen_head(ball), seen_hand(hand);
  const float height = kBall + 0.01f + kHand;
  const Pose begin{Vec3(static_cast<float>(-kWay / 2), height, 0), Quat::Identity()};
  Simulation simulation = laboratory.simulation(headOfHair(), {{{ball}, true}, {{hand}, false, false, begin}},
                                                frames(laboratory, 1));
  laboratory.advance(simulation, kSettling);
  Depths depths;
  for (double t = 0; t < 2 * kWay / kSpeed; t += simulation.parameters().time_step) {
    const double way = kWay / 2 - std::fabs(kWay - kSpeed * t);
    const Pose pose{Vec3(static_cast<float>(way), height, 0), Quat::Identity()};
    simulation.setBodyPose(1, pose);
    laboratory.advance(simulation, simulation.parameters().time_step);
    seen_head.see(simulation, {}, depths);
    seen_hand.see(simulation, pose, depths);
  }
  return motionCases("hand through the hair at 1 m/s", depths);
}

// A ball moves over the roots within half a second, until half of it is in the head, and stays.
constexpr const char* kCovered = "roots covered by a ball: speed";

std::vector<Case> coveredRoots(const Laboratory& laboratory) {
  constexpr double kSettling = 1.5, kComing = 0.5, kStaying = 3;  // s
  constexpr float kCover = 0.05f, kAway = 0.2f;                   // m
  const ContactPrimitive cover{PrimitiveKind::kSphere, Vec3::Zero(), Vec3::UnitY(), kCover};
  auto pose = [&](double part) {
    return Pose{Vec3(0, kBall + kAway * static_cast<float>(1 - part), 0), Quat::Identity()};
  };
  Simulation simulation = laboratory.simulation(
      headOfHair(), {{{ballShape()}, true}, {{cover}, false, false, pose(0)}}, frames(laboratory, 5));
  laboratory.advance(simulation, kSettling);
  const double step = simulation.parameters().time_step;
  for (double t = step; t < kComing + step / 2; t += step) {
    simulation.setBodyPose(1, pose(std::min(t / kComing, 1.0)));
    laboratory.advance(simulation, step);
  }
  laboratory.advance(simulation, kStaying);
  return {absoluteCase({kCovered, "largest rms speed of a strand after 3 s", "mm/s"},
                       1e3 * fastestOf(simulation), 0, 1)};
}

// A ball that overlaps the head by 5 mm moves along the scalp at 1 m/s, with hair in between. Loops of hair
// that it drags move at twice its speed, and tips at several times: up to 8 m/s with short steps.
constexpr const char* kRolled = "ball along the scalp at 1 m/s: fastest";

std::vector<Case> rolledOver(const Laboratory& laboratory) {
  constexpr double kSettling = 1.5, kSpeed = 1, kHalfTurn = 1;  // s, m/s, radians
  constexpr float kRoller = 0.04f, kOverlap = 0.005f;           // m
  constexpr double kRadius = static_cast<double>(kBall + kRoller - kOverlap);
  const ContactPrimitive roller{PrimitiveKind::kSphere, Vec3::Zero(), Vec3::UnitY(), kRoller};
  auto pose = [&](double angle) {
    return Pose{(kRadius * Eigen::Vector3d(std::sin(angle), std::cos(angle), 0)).cast<float>(),
                Quat::Identity()};
  };
  Simulation simulation =
      laboratory.simulation(headOfHair(), {{{ballShape()}, true}, {{roller}, false, false, pose(-kHalfTurn)}},
                            frames(laboratory, 1));
  laboratory.advance(simulation, kSettling);
  const double step = simulation.parameters().time_step;
  double fastest = 0;
  for (double angle = -kHalfTurn; angle < kHalfTurn; angle += kSpeed / kRadius * step) {
    simulation.setBodyPose(1, pose(angle));
    laboratory.advance(simulation, step);
    for (const Vec3& velocity : simulation.state().velocities)
      fastest = worse(fastest, static_cast<double>(velocity.norm()));
  }
  return {absoluteCase({kRolled, "largest speed of a vertex", "m/s"}, fastest, 0, 10)};
}

// Kinetic, potential and elastic energy over reference mass, m^2/s^2.
double energyOf(Simulation& simulation) {
  const StrandModel& model = simulation.model();
  const StrandState state = simulation.state();
  double energy = 0;
  for (size_t s = 0; s < model.strands(); ++s) {
    Eigen::Quaterniond inner = model.rest_roots[s].rotation.cast<double>();
    for (uint32_t v = model.offsets[s]; v + 1 < model.offsets[s + 1]; ++v) {
      const Eigen::Quaterniond outer = state.frames[v].cast<double>();
      const Eigen::Vector3d excess = strainOfJoint(inner, outer) - model.rest_strain[v].cast<double>();
      energy += 0.5 * (model.bend[v] * (excess.x() * excess.x() + excess.y() * excess.y()) +
                       model.twist[v] * excess.z() * excess.z());
      energy += model.mass[v + 1] * (0.5 * state.velocities[v + 1].cast<double>().squaredNorm() +
                                     kGravity * state.positions[v + 1].y());
      inner = outer;
    }
  }
  return energy;
}

constexpr double kEnergyFrictions[] = {0, 0.3, 1};
std::vector<std::string> namesOfEnergy() {
  return caseNames("energy falling on a sphere, friction={:g}", kEnergyFrictions);
}

// Energy added by contact, as a fraction of the energy lost. Each step is repeated from the same state
// without the sphere; the difference counts where the energy is higher with the sphere.
std::vector<Case> energyOfFall(const Laboratory& laboratory) {
  constexpr double kFalling = 2;  // s
  std::vector<Case> cases;
  for (size_t i = 0; i < std::size(kEnergyFrictions); ++i) {
    ContactPrimitive ball = ballShape();
    ball.friction = static_cast<float>(kEnergyFrictions[i]);
    const Parameters parameters = laboratory.parameters(360, 0);
    const StrandModel model = modelOf({droppedStrands(drops()[0].root)[0]});
    Simulation simulation = laboratory.simulation(model, {{{ball}, false}}, parameters);
    Simulation without = laboratory.simulation(model, parameters);
    const double first = energyOf(simulation);
    double added = 0;
    StrandState before = simulation.state();
    laboratory.advance(simulation, kFalling, [&] {
      without.backend().upload(before);
      without.step();
      const double more = energyOf(simulation) - energyOf(without);
      added = std::isnan(more) ? more : added + std::max(more, 0.0);
      before = simulation.state();
    });
    cases.push_back(absoluteCase({namesOfEnergy()[i], "added by contact, % of what is lost", "%"},
                                 100 * added / (first - energyOf(simulation)), 0, 1));
  }
  return cases;
}

}  // namespace

void addContactExperiments(std::vector<Experiment>& experiments) {
  experiments.push_back({"25 strands dropped on one shape after another", namesOfDrops(), droppedOn});
  experiments.push_back({"32 kinked strands fall on the ball that they stand on and a capsule",
                         {kKinkedPressed},
                         kinkedPressed});
  experiments.push_back({"25 strands on a mesh that is tilted by 23 degrees and moved by 5 cm, once a second",
                         {"mesh tilted and moved: vertices", "mesh tilted and moved: segments"},
                         rockingMesh});
  experiments.push_back({"a head of 200 strands shaken",
                         {"head shaken by 10 g at 2 Hz: vertices", "head shaken by 10 g at 2 Hz: segments"},
                         shakenHead});
  experiments.push_back(
      {"a hand going through a head of 200 strands and back",
       {"hand through the hair at 1 m/s: vertices", "hand through the hair at 1 m/s: segments"},
       sweptByHand});
  experiments.push_back({"a ball over the roots of a head of 200 strands", {kCovered}, coveredRoots});
  experiments.push_back({"a ball pressed along the scalp of a head of 200 strands", {kRolled}, rolledOver});
  experiments.push_back({"a strand falling on a sphere, no air", namesOfEnergy(), energyOfFall});
}

namespace {

constexpr int kSweptStrands = 1000;
constexpr double kPlateSpeed = 10;     // m/s
constexpr double kThickness = 0.01;    // m
constexpr double kTop = 0.04;          // m, top of the plate below the roots
constexpr double kPlateTravel = 0.15;  // m, travel; less than the strands reach below the plate's top

constexpr double kTilts[] = {0, 30, 60};  // degrees

std::string nameOf(double tilt) { return fmt::format("plate of 10 mm at 10 m/s, tilt={:g}", tilt); }

// Straight, wavy and curly strands of 20 to 30 cm, hanging from roots in one plane.
StrandModel hangingStrands() {
  std::mt19937 random(7);
  auto number = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  std::vector<StrandPoints> strands;
  for (int s = 0; s < kSweptStrands; ++s) {
    const double length = number(0.2, 0.3);
    strands.push_back(s % 2 == 0 ? straightStrand(length, kEdges, -Vec3::UnitY())
                                 : helixStrand(number(0.001, 0.005), number(0.02, 0.06), length, kEdges));
    const Vec3 root(static_cast<float>(number(0, 0.02)), 0, static_cast<float>(number(-0.3, 0.3)));
    for (Vec3& point : strands.back()) point += root;
  }
  return modelOf(strands);
}

// A plate with a horizontal top edge moves through the hair from behind, `tilt` degrees from upright.
std::vector<Case> plate(const Laboratory& laboratory, double tilt) {
  Parameters parameters = laboratory.parameters(60, 1);
  parameters.substeps = 4;
  ContactPrimitive box;
  box.kind = PrimitiveKind::kBox;
  box.extent = Vec3(static_cast<float>(kThickness / 2), 0.3f, 0.6f);
  box.a = Vec3(0, -0.3f, 0);  // the body's origin is the middle of the top edge
  const Quat turned(
      Eigen::AngleAxisf(static_cast<float>(tilt * std::numbers::pi / 180), Eigen::Vector3f::UnitZ()));
  auto pose = [&](double way) {
    return Pose{Vec3(static_cast<float>(way - 0.06), static_cast<float>(-kTop), 0), turned};
  };
  Simulation simulation = laboratory.simulation(hangingStrands(), {}, parameters);
  laboratory.advance(simulation, 1.5);
  // Starts behind the hair at any tilt of the plate.
  const double first = -0.3 * std::sin(tilt * std::numbers::pi / 180) * 2;
  const BodyId id = simulation.addBody({{box}, false, false, pose(first)});
  size_t vertices = 0, segments = 0;
  for (double way = first; way < kPlateTravel;) {
    way += kPlateSpeed * parameters.time_step;
    simulation.setBodyPose(id, pose(way));
    laboratory.advance(simulation, parameters.time_step);
    const Pose back = pose(way).inverse();
    for (size_t s = 0; s < kSweptStrands; ++s) {
      const std::span<const Vec3> strand = strandOf(simulation, s);
      for (size_t v = 1; v < strand.size(); ++v) {
        const Vec3 inner = back.apply(strand[v - 1]), outer = back.apply(strand[v]);
        // Behind the mid-plane and below the top counts as tunnelled; so does NaN.
        const auto through = [](const Vec3& p) { return !(p.x() >= 0 || p.y() >= 0); };
        vertices += through(outer) ? 1 : 0;
        if (!(inner.x() * outer.x() >= 0)) {  // the segment crosses the mid-plane
          const float part = inner.x() / (inner.x() - outer.x());
          segments += inner.y() + part * (outer.y() - inner.y()) >= 0 ? 0 : 1;
        }
      }
    }
  }
  return {absoluteCase({nameOf(tilt) + ": vertices", "found on the wrong side", ""},
                       static_cast<double>(vertices), 0, 0),
          absoluteCase({nameOf(tilt) + ": segments", "found across the plate", ""},
                       static_cast<double>(segments), 0, 0)};
}

}  // namespace

void addTunnelExperiments(std::vector<Experiment>& experiments) {
  for (const double tilt : kTilts)
    experiments.push_back(
        {fmt::format("1000 hanging strands swept by a plate, {:g} degrees from upright", tilt),
         {nameOf(tilt) + ": vertices", nameOf(tilt) + ": segments"},
         [tilt](const Laboratory& laboratory) { return plate(laboratory, tilt); }});
}

}  // namespace strandcast
