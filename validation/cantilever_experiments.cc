#include <fmt/format.h>

#include <cmath>
#include <map>
#include <span>

#include "core/error.h"
#include "validation/experiments.h"
#include "validation/rest_shapes.h"
#include "validation/specimen.h"

namespace strandcast {
namespace {

constexpr double kSettlingTime = 8;  // s
constexpr float kSettlingDrag = 5;   // 1/s
constexpr double kSettlingRates[] = {360, 720};

struct Cantilever {
  double gamma;
  int edges;                         ///< "vertices" in the names of cases: those that are not clamped
  double place = 1;                  ///< fraction of the length where properties change
  double stiffness = 1, radius = 1;  ///< factors beyond `place`, over those at the clamp
  double density = 1;                ///< factor just beyond `place`
  double growth = 0;                 ///< linear growth of the factor from `place` to the tip
};

ElasticaStep stepOf(const Cantilever& c) {
  return {c.place, c.stiffness * std::pow(c.radius, 4), c.radius * c.radius * c.density, c.growth};
}

Material materialOf(const Cantilever& c) {
  auto jump = [&](double factor) {
    const auto place = static_cast<float>(c.place), beyond = static_cast<float>(factor);
    return place > 0 ? RootTipCurve{{{place, 1.0f}, {place, beyond}}} : RootTipCurve{{{0.0f, beyond}}};
  };
  Material material;
  if (c.stiffness != 1) material.stiffness_scale = jump(c.stiffness);
  if (c.radius != 1) material.radius_scale = jump(c.radius);
  if (c.density != 1 || c.growth != 0) {
    material.density_scale = jump(c.density);
    material.density_scale.knots.emplace_back(1.0f, static_cast<float>(c.density + c.growth));
  }
  return material;
}

/// Drop over reach of the tips of horizontal strands of human hair at rest.
std::vector<double> restingSlopes(const Laboratory& laboratory, const std::vector<Cantilever>& cantilevers,
                                  double rate, float drag = kSettlingDrag, double settling = kSettlingTime) {
  std::vector<StrandPoints> strands;
  std::vector<Material> materials;
  for (const Cantilever& c : cantilevers) {
    strands.push_back(straightStrand(lengthOfGamma(c.gamma, Material{}), c.edges, Vec3::UnitX()));
    materials.push_back(materialOf(c));
  }
  Simulation simulation =
      laboratory.simulation(modelOf(strands, materials), laboratory.parameters(rate, drag));
  laboratory.advance(simulation, settling);
  std::vector<double> slopes;
  for (size_t s = 0; s < strands.size(); ++s) {
    const Vec3 tip = tipOf(simulation, s);
    slopes.push_back(-static_cast<double>(tip.y()) / tip.x());
  }
  return slopes;
}

const std::vector<Cantilever>& scoredCantilevers() {
  static const std::vector<Cantilever> list = {{0.1, 32}, {1, 32}, {10, 32}, {100, 32}, {1000, 64}};
  return list;
}

/// Limit of the error, % of drop over reach.
double limitOf(const Cantilever& c) {
  const double limit = c.gamma <= 10 ? 0.2 : c.gamma <= 100 ? 0.6 : 1.5;
  const double edges = c.gamma <= 100 ? 32 : 64;
  return limit * std::max(1.0, std::pow(edges / c.edges, 2));
}

std::string nameOf(const Cantilever& c) { return fmt::format("gamma={:g} vertices={}", c.gamma, c.edges); }

std::vector<std::string> namesOfSag() {
  std::vector<std::string> names;
  for (const Cantilever& cantilever : scoredCantilevers()) {
    const std::string name = nameOf(cantilever);
    names.insert(names.end(), {name, name + " rate=720", name + " rates agree"});
  }
  return names;
}

std::vector<Case> sag(const Laboratory& laboratory) {
  const std::vector<Cantilever>& cantilevers = scoredCantilevers();
  std::map<double, std::vector<double>> slopes;
  for (const double rate : kSettlingRates) slopes[rate] = restingSlopes(laboratory, cantilevers, rate);
  std::vector<Case> cases;
  for (size_t i = 0; i < cantilevers.size(); ++i) {
    const std::string name = nameOf(cantilevers[i]);
    const double truth = restingElastica(cantilevers[i].gamma, 0).slope();
    const double limit = limitOf(cantilevers[i]);
    cases.push_back(relativeCase({name, "tip H/W", ""}, slopes[360][i], truth, limit));
    cases.push_back(relativeCase({name + " rate=720", "tip H/W", ""}, slopes[720][i], truth, limit));
    const double apart = 100 * (slopes[360][i] - slopes[720][i]) / truth;
    cases.push_back(absoluteCase({name + " rates agree", "H/W at 1/360 less 1/720", "%"}, apart, 0, 0.3));
  }
  return cases;
}

// Slope of log |error| over log (edge length), by least squares.
double orderOf(std::span<const int> edges, std::span<const double> errors) {
  double x_mean = 0, y_mean = 0, xy = 0, xx = 0;
  const auto n = static_cast<double>(edges.size());
  for (size_t i = 0; i < edges.size(); ++i) {
    x_mean -= std::log(edges[i]) / n;
    y_mean += std::log(std::fabs(errors[i])) / n;
  }
  for (size_t i = 0; i < edges.size(); ++i) {
    const double x = -std::log(edges[i]) - x_mean;
    xy += x * (std::log(std::fabs(errors[i])) - y_mean);
    xx += x * x;
  }
  return xy / xx;
}

constexpr double kConvergenceGammas[] = {1, 10};

std::vector<std::string> namesOfConvergence() {
  return caseNames("gamma={:g} convergence", kConvergenceGammas);
}

std::vector<Case> convergence(const Laboratory& laboratory) {
  const std::vector<int> edges = {8, 16, 32, 64};
  std::vector<Cantilever> cantilevers;
  for (const double gamma : kConvergenceGammas)
    for (const int n : edges) cantilevers.push_back({gamma, n});
  const std::vector<double> slopes = restingSlopes(laboratory, cantilevers, 720);
  std::vector<Case> cases;
  for (size_t g = 0; g < std::size(kConvergenceGammas); ++g) {
    const double truth = restingElastica(kConvergenceGammas[g], 0).slope();
    std::vector<double> errors;
    std::string note = "from 8, 16 and 32 vertices; errors of H/W at 8, 16, 32, 64:";
    for (size_t i = 0; i < edges.size(); ++i) {
      errors.push_back(100 * (slopes[g * edges.size() + i] / truth - 1));
      note += fmt::format(" {:.4f} %", errors.back());
    }
    // At 64 vertices the errors of rounding and time step are as large as that of the edges.
    const double slope = orderOf(std::span(edges).first(3), std::span(errors).first(3));
    Case order = atLeastCase({namesOfConvergence()[g], "order of convergence", ""}, slope, 2, 0.2);
    order.note = note;
    cases.push_back(order);
  }
  return cases;
}

// With an even number of edges 0.5 is at a joint; 0.45 is inside an edge.
const std::vector<Cantilever>& steppedCantilevers() {
  static const std::vector<Cantilever> list = [] {
    std::vector<Cantilever> cantilevers;
    for (const Cantilever& c :
         {Cantilever{1, 0, 0.5, 0.1, 1}, Cantilever{1, 0, 0.45, 0.1, 1}, Cantilever{1, 0, 0.45, 10, 1},
          Cantilever{1, 0, 0.45, 1, 0.6}, Cantilever{1, 0, 0.45, 1, 1, 0.2}, Cantilever{1, 0, 0.45, 1, 1, 5},
          Cantilever{1, 0, 0, 1, 1, 1, 4}, Cantilever{1, 0, 0, 1, 1, 1, -0.9}})
      for (const int edges : {8, 16, 32}) {
        cantilevers.push_back(c);
        cantilevers.back().edges = edges;
      }
    return cantilevers;
  }();
  return list;
}

std::vector<std::string> namesOfSteps() {
  std::vector<std::string> names;
  for (const Cantilever& c : steppedCantilevers()) {
    const std::string name = nameOf(c);
    if (c.growth != 0)
      names.push_back(fmt::format("{} evenly up to {:g} x as dense", name, c.density + c.growth));
    else if (c.density != 1)
      names.push_back(fmt::format("{} {:g} x as dense from {:g}", name, c.density, c.place));
    else
      names.push_back(fmt::format("{} {:g} x {} from {:g}", name, c.radius != 1 ? c.radius : c.stiffness,
                                  c.radius != 1 ? "as thick" : "as stiff", c.place));
  }
  return names;
}

std::vector<Case> steps(const Laboratory& laboratory) {
  const std::vector<Cantilever>& cantilevers = steppedCantilevers();
  const std::vector<double> slopes = restingSlopes(laboratory, cantilevers, 360);
  const std::vector<std::string> names = namesOfSteps();
  std::vector<Case> cases;
  for (size_t i = 0; i < cantilevers.size(); ++i) {
    const double truth = restingElastica(cantilevers[i].gamma, 0, stepOf(cantilevers[i])).slope();
    cases.push_back(relativeCase({names[i], "tip H/W", ""}, slopes[i], truth, limitOf(cantilevers[i])));
  }
  return cases;
}

void checkNumber(const char* name, double value, double low, double high) {
  if (!(value >= low && value <= high))
    throw Error("a number is out of range", fmt::format("{} {:g}", name, value),
                fmt::format("give {:g} to {:g}", low, high));
}

}  // namespace

Suite cantileverSuite(const CantileverNumbers& numbers) {
  checkNumber("gamma", numbers.gamma, 1e-3, 1e4);
  checkNumber("vertices", numbers.vertices, 2, 127);
  checkNumber("dt", numbers.time_step, 1e-5, 1 / 30.);
  checkNumber("damping", numbers.damping, 0.05, 100);
  const Cantilever cantilever{numbers.gamma, numbers.vertices};
  const std::string name = nameOf(cantilever);
  auto run = [=](const Laboratory& laboratory) {
    constexpr double kDecay = 40;  // drag x time, after which oscillations have decayed
    const double settling = std::max(kSettlingTime, kDecay / numbers.damping);
    const double slope = restingSlopes(laboratory, {cantilever}, 1 / numbers.time_step,
                                       static_cast<float>(numbers.damping), settling)[0];
    return std::vector<Case>{relativeCase({name, "tip H/W", ""}, slope,
                                          restingElastica(numbers.gamma, 0).slope(), limitOf(cantilever))};
  };
  return {"cantilever",
          "a heavy clamped elastica at rest",
          {{"a horizontal strand sags under its own weight", {name}, run}}};
}

void addCantileverExperiments(std::vector<Experiment>& experiments) {
  experiments.push_back(
      {"horizontal strands of as many edges sag under their own weight", namesOfSag(), sag});
  experiments.push_back({"the same with more and more vertices", namesOfConvergence(), convergence});
  experiments.push_back(
      {"the same, softer, stiffer, thinner, lighter or heavier from some place on", namesOfSteps(), steps});
}

}  // namespace strandcast
