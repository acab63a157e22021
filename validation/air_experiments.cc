#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "air/wind_grid.h"
#include "validation/experiments.h"
#include "validation/specimen.h"
#include "validation/wind_elastica.h"

namespace strandcast {
namespace {

using Grid = WindGrid<float>;

constexpr int kSizes[] = {16, 32, 64};

const char* schemeName(bool mac_cormack) { return mac_cormack ? "MacCormack" : "semi-Lagrangian"; }

// Error of the velocity after 1 s over its largest, rms. Cell and time step shrink together, the Courant
// number stays.
double taylorGreenError(const Laboratory& laboratory, const Workers& workers, int cells, bool mac_cormack) {
  constexpr double kViscosity = 0.05, kSeconds = 1;
  Grid grid(passesOf(laboratory.backendName()), workers, cells, static_cast<float>(std::numbers::pi / cells),
            Grid::Border::kClosed);
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

// The splitting into advection and projection is of the first order, whatever the advection is.
std::vector<Case> taylorGreen(const Laboratory& laboratory) {
  constexpr double kLimitAt16 = 5;  // % of the largest velocity; half of it with half the cell
  const std::vector<std::string> names = namesOfTaylorGreen();
  const Workers workers(1);
  std::vector<Case> cases;
  for (const bool mac_cormack : {false, true}) {
    double before = 0, error = 0;
    for (const int cells : kSizes) {
      before = error;
      error = taylorGreenError(laboratory, workers, cells, mac_cormack);
      cases.push_back(absoluteCase({names[cases.size()], "rms error of the velocity, % of the largest", "%"},
                                   100 * error, 0, kLimitAt16 * 16 / cells));
    }
    cases.push_back(
        atLeastCase({names[cases.size()], "order from 32^3 to 64^3", ""}, std::log2(before / error), 1, 0.1));
  }
  return cases;
}

// A blob off the axis is carried once round by a rigid rotation; the component along the axis is its density.
std::vector<std::string> namesOfBlob() {
  return {"blob's mass semi-Lagrangian", "blob's shape semi-Lagrangian", "blob's mass MacCormack",
          "blob's shape MacCormack"};
}

constexpr double kBlob = 0.07;  // of the grid's edge, standard deviation

// Error of a Gaussian of standard deviation `size` cells after `steps` linear interpolations over its own
// rms: each adds on average 1/6 cell^2 to its variance along every axis.
double blurredError(double size, int steps) {
  const double before = size * size, after = before + steps / 6.0;
  return std::sqrt(1 + before / after - 4 * before / (before + after));
}

std::vector<Case> blob(const Laboratory& laboratory) {
  constexpr int kCells = 64, kSteps = 160;
  const std::vector<std::string> names = namesOfBlob();
  const Workers workers(1);
  std::vector<Case> cases;
  for (const bool mac_cormack : {false, true}) {
    Grid grid(passesOf(laboratory.backendName()), workers, kCells, 1.0f / kCells, Grid::Border::kClosed);
    auto initial = [](const Vec3& x) {
      const double square = std::pow(x.x() - 0.5, 2) + std::pow(x.y() - 0.7, 2);
      return std::exp(-square / (2 * kBlob * kBlob));
    };
    grid.setVelocity(
        [&](const Vec3& x) { return Vec3(0.5f - x.y(), x.x() - 0.5f, static_cast<float>(initial(x))); });
    auto density = [&](const Vec3& x, int axis, int i, int j, int k) {
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
    cases.push_back(mac_cormack ? absoluteCase(shape, error, 0, 10)
                                : relativeCase(shape, error, 100 * blurredError(kBlob * kCells, kSteps), 10));
  }
  return cases;
}

constexpr double kSphere = 0.1, kWind = 3;  // m, m/s

std::vector<Case> sphere(const Laboratory& laboratory) {
  constexpr int kCells = 64, kSettling = 120, kWatching = 120;
  constexpr double kStep = 1.0 / 60;
  const Workers workers(1);
  Grid grid(passesOf(laboratory.backendName()), workers, kCells, 0.8f / kCells, Grid::Border::kOpen);
  Parameters parameters;
  parameters.wind = Vec3(static_cast<float>(kWind), 0, 0);
  grid.ambient().configure(parameters);
  grid.centreAt(Vec3::Zero());
  grid.reset();
  ContactPrimitive ball;
  ball.radius = static_cast<float>(kSphere);
  const MovingPrimitive body = moved(ball, Pose{}, Pose{}, static_cast<float>(kStep));
  double outflow = 0, lee_along = 0, lee = 0;
  std::vector<Vec3> places, means;  // across the disc of the sphere's radius, one radius behind it
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

constexpr double kLoads[] = {1, 10, 100};  // rate x wind x L^3 / (B / mass per length)

std::vector<std::string> namesOfDeflection() { return caseNames("strand in the wind load={:g}", kLoads); }

std::vector<Case> deflection(const Laboratory& laboratory) {
  constexpr double kLength = 0.1, kAlong = 0.5;
  constexpr float kDrag = 5;
  std::vector<Case> cases;
  for (const double load : kLoads) {
    Parameters parameters = laboratory.parameters(360, kDrag);
    parameters.gravity.setZero();
    parameters.wind_grid = 1;
    parameters.grid_cells = 16;
    parameters.air_drag_along = static_cast<float>(kAlong);
    parameters.hairs_per_strand = 0;  // the wind of the truth is uniform
    parameters.wind.x() =
        static_cast<float>(load * bendingOverMass(Material{}) / (kDrag * std::pow(kLength, 3)));
    Simulation simulation =
        laboratory.simulation(modelOf({straightStrand(kLength, 32, -Vec3::UnitY())}), parameters);
    laboratory.advance(simulation, 5);
    cases.push_back(relativeCase({namesOfDeflection()[cases.size()], "tip downwind/L", ""},
                                 static_cast<double>(tipOf(simulation, 0).x()) / kLength,
                                 windElastica(load, kAlong).downwind, 2));
  }
  return cases;
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
  experiments.push_back({"a strand of 10 cm clamped across a uniform wind, drag along half of that across",
                         namesOfDeflection(), deflection});
}

}  // namespace strandcast
