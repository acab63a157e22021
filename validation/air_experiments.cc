#include <fmt/format.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "validation/experiments.h"
#include "validation/rest_shapes.h"
#include "validation/specimen.h"

namespace strandcast {
namespace {

constexpr int kSizes[] = {16, 32, 64};

const char* schemeName(bool mac_cormack) { return mac_cormack ? "MacCormack" : "semi-Lagrangian"; }

// Rms error of the velocity after 1 s over its largest value. Cell and time step shrink together at a
// constant Courant number.
double taylorGreenError(const Laboratory& laboratory, int cells, bool mac_cormack) {
  constexpr double kViscosity = 0.05, kSeconds = 1;
  const std::unique_ptr<Wind> wind =
      laboratory.air().wind(cells, static_cast<float>(std::numbers::pi / cells), Wind::Border::kClosed);
  Wind& grid = *wind;
  auto exact = [](const Vec3& x, double t) {
    const auto left = static_cast<float>(std::exp(-2 * kViscosity * t));
    return Vec3(std::sin(x.x()) * std::cos(x.y()) * left, -std::cos(x.x()) * std::sin(x.y()) * left, 0);
  };
  grid.setVelocity([&](const Vec3& x) { return exact(x, 0); });
  for (int step = 0; step < cells; ++step) {
    laboratory.checkStopped();
    grid.advect(kSeconds / cells, mac_cormack);
    grid.diffuse(kSeconds / cells, kViscosity);
    grid.project();
  }
  double squares = 0;
  for (int axis = 0; axis < 2; ++axis)
    for (int k = 0; k < cells; ++k)
      for (int j = 0; j < cells; ++j)
        for (int i = 0; i < cells; ++i) {
          const double truth = static_cast<double>(exact(grid.placeOf(axis, i, j, k), kSeconds)[axis]);
          squares += std::pow(grid.component(axis, i, j, k) - truth, 2);
        }
  return std::sqrt(squares / (2 * std::pow(cells, 3))) / std::exp(-2 * kViscosity * kSeconds);
}

std::vector<std::string> namesOfTaylorGreen() {
  std::vector<std::string> names;
  for (const bool mac_cormack : {false, true}) {
    for (const int cells : kSizes)
      names.push_back(fmt::format("Taylor-Green {}^3 {}", cells, schemeName(mac_cormack)));
    names.push_back(fmt::format("Taylor-Green order {}", schemeName(mac_cormack)));
  }
  return names;
}

// The splitting into advection and projection is first order, with either advection.
std::vector<Case> taylorGreen(const Laboratory& laboratory) {
  constexpr double kLimitAt16 = 5;  // % of the largest velocity; half of it with half the cell
  const std::vector<std::string> names = namesOfTaylorGreen();
  std::vector<Case> cases;
  for (const bool mac_cormack : {false, true}) {
    double before = 0, error = 0;
    for (const int cells : kSizes) {
      before = error;
      error = taylorGreenError(laboratory, cells, mac_cormack);
      cases.push_back(absoluteCase({names[cases.size()], "rms error of the velocity, % of the largest", "%"},
                                   100 * error, 0, kLimitAt16 * 16 / cells));
    }
    cases.push_back(
        atLeastCase({names[cases.size()], "order from 32^3 to 64^3", ""}, std::log2(before / error), 1, 0.1));
  }
  return cases;
}

// A rigid rotation carries a blob once around the axis. The velocity component along the axis is its density.
std::vector<std::string> namesOfBlob() {
  return {"blob's mass semi-Lagrangian", "blob's shape semi-Lagrangian", "blob's mass MacCormack",
          "blob's shape MacCormack"};
}

constexpr double kBlob = 0.07;  // standard deviation over the edge of the grid

// Predicted relative rms error of a Gaussian of standard deviation `size` cells after `steps` steps of one
// turn at `radius` cells, by von Neumann analysis. Each step multiplies a Fourier mode by the factor g of
// linear interpolation; the MacCormack correction multiplies it by (3 - |g|^2) / 2 (Selle and others 2008).
// Without the limiter, and with the velocity at the blob's centre for the whole blob.
double carriedRoundError(double size, double radius, int steps, bool mac_cormack) {
  using Complex = std::complex<double>;
  constexpr int kModes = 20;       // per sign and axis
  const double most = 3.5 / size;  // 1/cell; the blob's spectrum is e^(-6) there
  const double turn = 2 * std::numbers::pi / steps;
  auto interpolated = [](double way, double wave) {
    return 1 - std::fabs(way) + std::fabs(way) * std::polar(1.0, way > 0 ? -wave : wave);
  };
  double off = 0, all = 0;
  for (int m = -kModes; m <= kModes; ++m)
    for (int n = -kModes; n <= kModes; ++n) {
      const double x = most * m / kModes, y = most * n / kModes;
      Complex left = 1;
      for (int step = 0; step < steps; ++step) {
        const double angle = turn * (step + 0.5), c = std::cos(angle), s = std::sin(angle);
        const double way[2] = {
            -radius * turn * s,
            radius * turn * c};  // displacement in the step of a blob that started on the x axis
        const double wave[2] = {c * x - s * y, s * x + c * y};  // wave vector of a mode that rotates with it
        const Complex g = interpolated(way[0], wave[0]) * interpolated(way[1], wave[1]);
        const Complex factor = mac_cormack ? g + 0.5 * (1 - std::norm(g)) : g;
        left *= factor * std::polar(1.0, wave[0] * way[0] + wave[1] * way[1]);
      }
      const double power = std::exp(-(x * x + y * y) * size * size);
      off += power * std::norm(left - 1.0);
      all += power;
    }
  return std::sqrt(off / all);
}

std::vector<Case> blob(const Laboratory& laboratory) {
  constexpr int kCells = 64, kSteps = 160;
  const std::vector<std::string> names = namesOfBlob();
  std::vector<Case> cases;
  for (const bool mac_cormack : {false, true}) {
    const std::unique_ptr<Wind> wind = laboratory.air().wind(kCells, 1.0f / kCells, Wind::Border::kClosed);
    Wind& grid = *wind;
    auto initial = [](const Vec3& x) {
      const double square = std::pow(x.x() - 0.5, 2) + std::pow(x.y() - 0.7, 2);
      return std::exp(-square / (2 * kBlob * kBlob));
    };
    grid.setVelocity(
        [&](const Vec3& x) { return Vec3(0.5f - x.y(), x.x() - 0.5f, static_cast<float>(initial(x))); });
    auto density = [&](int axis, int i, int j, int k) {
      const Vec3 x = grid.placeOf(axis, i, j, k);
      return axis == 2 ? static_cast<float>(grid.component(2, i, j, k))
                       : (axis == 0 ? 0.5f - x.y() : x.x() - 0.5f);
    };
    for (int step = 0; step < kSteps; ++step) {
      laboratory.checkStopped();
      grid.advect(2 * std::numbers::pi / kSteps, mac_cormack);
      grid.setComponents(density);
    }
    double mass = 0, mass_before = 0, off = 0, square = 0;
    for (int j = 0; j < kCells; ++j)
      for (int i = 0; i < kCells; ++i) {
        const double now = grid.component(2, i, j, kCells / 2),
                     then = initial(grid.placeOf(2, i, j, kCells / 2));
        mass += now;
        mass_before += then;
        off += std::pow(now - then, 2);
        square += then * then;
      }
    cases.push_back(
        relativeCase({names[cases.size()], "mass over that before", ""}, mass / mass_before, 1, 1));
    const Quantity shape{names[cases.size()], "rms error, % of the blob's rms", "%"};
    const double error = 100 * std::sqrt(off / square);
    const double truth = 100 * carriedRoundError(kBlob * kCells, 0.2 * kCells, kSteps, mac_cormack);
    cases.push_back(relativeCase(shape, error, truth, 10));
  }
  return cases;
}

constexpr double kSphere = 0.1, kWind = 3;  // m, m/s

std::vector<Case> sphere(const Laboratory& laboratory) {
  constexpr int kCells = 64, kSettling = 120, kWatching = 120;
  constexpr double kStep = 1.0 / 60;
  const std::unique_ptr<Wind> wind = laboratory.air().wind(kCells, 0.8f / kCells, Wind::Border::kOpen);
  Wind& grid = *wind;
  Parameters parameters;
  parameters.wind = Vec3(static_cast<float>(kWind), 0, 0);
  grid.ambient().configure(parameters);
  grid.centreAt(Vec3::Zero());
  grid.reset();
  ContactPrimitive ball;
  ball.radius = static_cast<float>(kSphere);
  const MovingPrimitive body = moved(ball, Pose{}, Pose{}, static_cast<float>(kStep));
  double outflow = 0, lee_along = 0, lee = 0;
  std::vector<Vec3> places, means;  // on a disc of the sphere's radius, one radius behind the sphere
  const auto radius = static_cast<float>(kSphere);
  for (float y = -0.95f; y < 1; y += 0.1f)
    for (float z = -0.95f; z < 1; z += 0.1f)
      if (y * y + z * z < 1) places.emplace_back(2 * radius, y * radius, z * radius);
  means.assign(places.size(), Vec3::Zero());
  for (int step = 0; step < kSettling + kWatching; ++step) {
    laboratory.checkStopped();
    grid.clearSolids();
    grid.addSolids({&body, 1}, {}, kStep);
    grid.advect(kStep, false);
    grid.project();
    outflow = worse(outflow, grid.largestOutflow() / grid.fastest());
    for (size_t i = 0; step >= kSettling && i < places.size(); ++i)
      means[i] += grid.velocityAt(places[i]) / static_cast<float>(kWatching);
  }
  for (const Vec3& mean : means) {
    lee_along += static_cast<double>(mean.x()) / static_cast<double>(means.size());
    lee += static_cast<double>(mean.norm()) / static_cast<double>(means.size());
  }
  Case behind =
      absoluteCase({"lee of a sphere", "mean speed over the disc one radius behind it, % of the wind", "%"},
                   100 * lee / kWind, 0, 20);
  behind.note = fmt::format("along the wind {:.1f} %", 100 * lee_along / kWind);
  return {absoluteCase({"divergence around a sphere", "largest, x cell / largest velocity", ""}, outflow, 0,
                       1e-3),
          behind};
}

// Exact flow of a sphere source: radial, with the speed u R^2 / r^2 at the distance r.
constexpr double kSource = 0.1, kSourceSpeed = 3, kSourceBox = 1.2;  // m, m/s, m

WindSource sourceSphere() {
  WindSource sphere;
  sphere.kind = WindSource::Kind::kSphere;
  sphere.position = Vec3(0.013f, -0.021f, 0.007f);  // not at a corner or centre of a cell
  sphere.radius = static_cast<float>(kSource);
  sphere.speed = static_cast<float>(kSourceSpeed);
  return sphere;
}

// Flow at two radii from the centre of a sphere, in units of the exact speed there.
struct SourceFlow {
  double mean = 0, scatter = 0;  ///< of the radial velocity
  double error = 0;              ///< rms error of the velocity
};

SourceFlow flowAround(const Wind& grid, const WindSource& sphere) {
  constexpr int kDirections = 400;
  const double turn = std::numbers::pi * (3 - std::sqrt(5.0)), exact = kSourceSpeed / 4;
  SourceFlow flow;
  double squares = 0;
  for (int n = 0; n < kDirections; ++n) {  // evenly distributed on a spiral
    const double z = 1 - (2 * n + 1.0) / kDirections, across = std::sqrt(1 - z * z);
    const Vec3 way(static_cast<float>(across * std::cos(turn * n)),
                   static_cast<float>(across * std::sin(turn * n)), static_cast<float>(z));
    const Eigen::Vector3d velocity =
        grid.velocityAt(sphere.position + 2 * sphere.radius * way).cast<double>() / exact;
    const double along = velocity.dot(way.cast<double>());
    flow.mean += along / kDirections;
    squares += along * along / kDirections;
    flow.error += (velocity - way.cast<double>()).squaredNorm() / kDirections;
  }
  flow.scatter = std::sqrt(std::max(0.0, squares - flow.mean * flow.mean));
  flow.error = std::sqrt(flow.error);
  return flow;
}

std::vector<std::string> namesOfSource() {
  std::vector<std::string> names;
  for (const int cells : kSizes) names.push_back(fmt::format("sphere of wind {}^3", cells));
  names.insert(names.end(), {"sphere of wind order", "sphere of wind: speed", "sphere of wind: evenness",
                             "sphere of wind: flow", "sphere of wind: divergence"});
  return names;
}

// The flow is established after one step. Differences between directions then grow: diverging flow stretches
// vorticity and slows down, so a relative deviation at the surface is 16 times as large at two radii.
std::vector<Case> windFromSphere(const Laboratory& laboratory) {
  constexpr double kStep = 1.0 / 60, kLimits[] = {15, 5, 1.7};  // %
  constexpr int kSteps = 30;
  const std::vector<std::string> names = namesOfSource();
  const WindSource sphere = sourceSphere();
  std::vector<Case> cases;
  double before = 0, error = 0, outflow = 0;
  std::unique_ptr<Wind> wind;
  const auto step = [&] {
    laboratory.checkStopped();
    wind->setSources({&sphere, 1});
    wind->advect(kStep, false);
    wind->exchange(kStep);
    wind->project();
    outflow = worse(outflow, wind->largestOutflow() / wind->fastest());
  };
  for (const int cells : kSizes) {
    wind = laboratory.air().wind(cells, static_cast<float>(kSourceBox / cells), Wind::Border::kOpen);
    wind->centreAt(Vec3::Zero());
    wind->reset();
    step();
    before = error;
    error = flowAround(*wind, sphere).error;
    cases.push_back(absoluteCase(
        {names[cases.size()], "rms error of the velocity two radii away after a step, % of u/4", "%"},
        100 * error, 0, kLimits[cases.size()]));
  }
  cases.push_back(
      atLeastCase({names[cases.size()], "order from 32^3 to 64^3", ""}, std::log2(before / error), 1.5, 0.1));
  for (int n = 1; n < kSteps; ++n) step();
  const SourceFlow flow = flowAround(*wind, sphere);
  cases.push_back(relativeCase({names[cases.size()], "mean two radii away after 0.5 s", "m/s"},
                               kSourceSpeed / 4 * flow.mean, kSourceSpeed / 4, 1));
  cases.push_back(absoluteCase({names[cases.size()], "scatter of that over directions, % of u/4", "%"},
                               100 * flow.scatter, 0, 15));
  cases.push_back(relativeCase({names[cases.size()], "through the border of the grid, over 4 pi R^2 u", ""},
                               wind->flowOut() / (4 * std::numbers::pi * kSource * kSource * kSourceSpeed), 1,
                               1));
  cases.push_back(absoluteCase(
      {names[cases.size()], "largest of what is left, x cell / largest velocity", ""}, outflow, 0, 1e-3));
  return cases;
}

constexpr double kLoads[] = {1, 10, 100, 10};  // rate x wind x L^3 / (B / mass per length)
constexpr double kDrags[] = {5, 5, 5, 100};    // 1/s

std::vector<std::string> namesOfDeflection() {
  std::vector<std::string> names = caseNames("strand in the wind load={:g}", kLoads);
  names.back() += " drag=100";
  return names;
}

std::vector<Case> deflection(const Laboratory& laboratory) {
  constexpr double kLength = 0.1, kAlong = 0.5;
  std::vector<Case> cases;
  for (size_t i = 0; i < std::size(kLoads); ++i) {
    const double load = kLoads[i], drag = kDrags[i];
    Parameters parameters = laboratory.parameters(360, static_cast<float>(drag));
    parameters.gravity.setZero();
    parameters.wind_grid = 1;
    parameters.grid_cells = 16;
    parameters.air_drag_along = static_cast<float>(kAlong);
    parameters.hairs_per_strand = 0;  // hair must not slow the wind: the exact solution has a uniform one
    parameters.wind.x() =
        static_cast<float>(load * bendingOverMass(Material{}) / (drag * std::pow(kLength, 3)));
    Simulation simulation =
        laboratory.simulation(modelOf({straightStrand(kLength, 32, -Vec3::UnitY())}), parameters);
    laboratory.advance(simulation, 5);
    cases.push_back(relativeCase({namesOfDeflection()[cases.size()], "tip downwind/L", ""},
                                 static_cast<double>(tipOf(simulation, 0).x()) / kLength,
                                 windElastica(load, kAlong).downwind, 2));
  }
  return cases;
}

// A hair drier blows at a head from one side: displacements of the tips on both sides.
std::vector<Case> hairDrier(const Laboratory& laboratory) {
  constexpr double kSeconds = 2, kWatched = 1;
  Parameters parameters = laboratory.parameters(60, 5);
  parameters.substeps = 4;
  parameters.damping_time = 5e-4f;
  parameters.gravity.setZero();
  parameters.wind_grid = 1;
  WindSource drier;
  drier.kind = WindSource::Kind::kTurbine;
  drier.position = Vec3(-0.45f, 0.05f, 0);
  drier.direction = Vec3::UnitX();
  drier.radius = 0.15f;
  drier.length = 0.1f;
  drier.speed = 8;
  drier.rate = 100;
  const StrandModel model = headOfHair(500, 0.15, 15, 2);
  Simulation simulation = laboratory.simulation(model, {headBody()}, parameters, {drier});
  const std::vector<Vec3> rest(simulation.guides().begin(), simulation.guides().end());
  double squares[2] = {}, counts[2] = {};  // on the windward side, on the lee side
  laboratory.advance(simulation, kSeconds, [&] {
    if (simulation.time() < kSeconds - kWatched) return;
    for (size_t s = 0; s < model.strands(); ++s) {
      const float side = rest[model.offsets[s]].x() / kHeadRadius;
      if (std::fabs(side) < 0.5f) continue;
      const size_t tip = model.offsets[s + 1] - 1, which = side < 0 ? 0 : 1;
      squares[which] += (simulation.guides()[tip] - rest[tip]).cast<double>().squaredNorm();
      ++counts[which];
    }
  });
  const double windward = std::sqrt(squares[0] / counts[0]), lee = std::sqrt(squares[1] / counts[1]);
  Case out = absoluteCase({"hair in the lee", "rms way of its tips over that of tips in the wind", ""},
                          lee / windward, 0, 0.3);
  out.note = fmt::format("in the wind {:.1f} mm, in the lee {:.1f} mm", 1e3 * windward, 1e3 * lee);
  return {out};
}

}  // namespace

void addAirExperiments(std::vector<Experiment>& experiments) {
  experiments.push_back(
      {"a decaying Taylor-Green vortex in a closed box of pi m, viscosity 0.05 m^2/s, for 1 s",
       namesOfTaylorGreen(), taylorGreen});
  experiments.push_back(
      {"a blob carried once round by a rigid rotation, 64^3, 160 steps", namesOfBlob(), blob});
  experiments.push_back({"wind of 3 m/s around a sphere of radius 0.1 m in a box of 0.8 m, 64^3, 4 s",
                         {"divergence around a sphere", "lee of a sphere"},
                         sphere});
  experiments.push_back({"a sphere of radius 0.1 m that blows at u = 3 m/s in still air, in a box of 1.2 m",
                         namesOfSource(), windFromSphere});
  experiments.push_back({"a hair-drier of 8 m/s blows at a head of 500 strands of 15 cm from one side, 2 s",
                         {"hair in the lee"},
                         hairDrier});
  experiments.push_back({"a strand of 10 cm clamped across a uniform wind, drag along half of that across",
                         namesOfDeflection(), deflection});
}

}  // namespace strandcast
