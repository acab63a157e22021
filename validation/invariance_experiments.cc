#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "validation/experiments.h"
#include "validation/specimen.h"

namespace strandcast {
namespace {

std::vector<StrandPoints> strands(float scale) {
  std::vector<StrandPoints> list = {straightStrand(0.1, kEdges, Vec3::UnitX()),
                                    helixStrand(0.01, 0.01, 0.2, kEdges)};
  for (StrandPoints& points : list)
    for (Vec3& x : points) x *= scale;
  return list;
}

// Largest distance between corresponding vertices, % of the strand's length.
double difference(std::span<const Vec3> a, std::span<const Vec3> b) {
  double largest = 0;
  for (size_t v = 0; v < a.size(); ++v) largest = worse(largest, (a[v] - b[v]).cast<double>().norm());
  return 100 * largest / arcLength(a);
}

using Shapes = std::vector<std::vector<Vec3>>;  // positions per strand

Shapes shapesOf(Simulation& simulation) {
  Shapes shapes;
  for (size_t s = 0; s < simulation.model().strands(); ++s) {
    const std::span<const Vec3> strand = strandOf(simulation, s);
    shapes.emplace_back(strand.begin(), strand.end());
  }
  return shapes;
}

double difference(const Shapes& a, const Shapes& b) {
  double largest = 0;
  for (size_t s = 0; s < a.size(); ++s) largest = worse(largest, difference(a[s], b[s]));
  return largest;
}

constexpr double kRates[] = {120, 240, 480, 960};

constexpr const char* kRestStrands[] = {"straight", "helix"};

std::vector<std::string> namesOfRestShape() {
  std::vector<std::string> names;
  for (const std::string strand : kRestStrands)
    names.insert(names.end(), {"time step " + strand, "air drag " + strand});
  return names;
}

std::vector<Case> restShape(const Laboratory& laboratory) {
  std::vector<Shapes> by_rate;
  double by_drag[] = {0, 0};
  for (const double rate : kRates) {
    Parameters parameters = laboratory.parameters(rate, 5);
    Simulation simulation = laboratory.simulation(modelOf(strands(1)), parameters);
    laboratory.advance(simulation, 10);
    by_rate.push_back(shapesOf(simulation));
    for (const float drag : {0.1f, 10.0f}) {
      parameters.air_drag = drag;
      simulation.setParameters(parameters);
      laboratory.advance(simulation, 2);
      const Shapes now = shapesOf(simulation);
      for (size_t s = 0; s < now.size(); ++s)
        by_drag[s] = worse(by_drag[s], difference(by_rate.back()[s], now[s]));
    }
  }
  std::vector<Case> cases;
  for (size_t s = 0; s < by_rate[0].size(); ++s) {
    double by_step = 0;
    std::string note = "at 1/120, 1/240, 1/480 s against 1/960 s:";
    for (size_t r = 0; r + 1 < by_rate.size(); ++r) {
      const double apart = difference(by_rate.back()[s], by_rate[r][s]);
      by_step = worse(by_step, apart);
      note += fmt::format(" {:.3f}", apart);
    }
    cases.push_back(
        absoluteCase({namesOfRestShape()[2 * s], "change of the rest shape", "% of L"}, by_step, 0, 0.1));
    cases.back().note = note;
    cases.push_back(absoluteCase({namesOfRestShape()[2 * s + 1], "change of the rest shape", "% of L"},
                                 by_drag[s], 0, 0.1));
    cases.back().note = "settled at 5/s, then 2 s at 0.1/s and 2 s at 10/s, at each time step";
  }
  return cases;
}

std::vector<std::string> namesOfInternalDamping() {
  std::vector<std::string> names;
  for (const std::string strand : kRestStrands) names.push_back("internal damping " + strand);
  return names;
}

std::vector<Case> internalDamping(const Laboratory& laboratory) {
  const auto settled = [&](float damping_time) {
    Parameters parameters = laboratory.parameters(kRate, 5);
    parameters.damping_time = damping_time;
    Simulation simulation = laboratory.simulation(modelOf(strands(1)), parameters);
    laboratory.advance(simulation, 10);
    return shapesOf(simulation);
  };
  const Shapes undamped = settled(0);
  double apart[] = {0, 0};
  for (const float damping_time : {0.002f, 0.02f, 0.1f}) {
    const Shapes damped = settled(damping_time);
    for (size_t s = 0; s < damped.size(); ++s) apart[s] = worse(apart[s], difference(undamped[s], damped[s]));
  }
  std::vector<Case> cases;
  for (size_t s = 0; s < undamped.size(); ++s)
    cases.push_back(
        absoluteCase({namesOfInternalDamping()[s], "change of the rest shape", "% of L"}, apart[s], 0, 0.1));
  return cases;
}

Pose nod(double t) {
  const auto phase = static_cast<float>(2 * std::numbers::pi * t);
  return {Vec3(0.05f * std::sin(phase), 0, 0),
          Quat(Eigen::AngleAxisf(0.4f * std::sin(phase), Eigen::Vector3f::UnitZ()))};
}

std::vector<Case> order(const Laboratory& laboratory) {
  Shapes shapes[2];
  for (const bool reversed : {false, true}) {
    std::vector<StrandPoints> list = strands(1);
    list.insert(list.end(), {straightStrand(0.05, 7, Vec3::UnitZ()), arcStrand(30, 0.15, 20)});
    if (reversed) std::reverse(list.begin(), list.end());
    Simulation simulation = laboratory.simulation(modelOf(list), laboratory.parameters(240, 1));
    laboratory.advance(simulation, 1, nod, {});
    shapes[reversed] = shapesOf(simulation);
  }
  std::reverse(shapes[1].begin(), shapes[1].end());
  return {absoluteCase({"order of strands", "change of the motion", "% of L"},
                       difference(shapes[0], shapes[1]), 0, 0)};
}

// Lengths and gravity are scaled by a power of two and E / rho by its square. The motion is then equal to the
// last bit, unless some constant of the solver is a length.
std::vector<Case> units(const Laboratory& laboratory) {
  std::vector<Shapes> shapes;
  for (const float scale : {1.0f, 128.0f}) {
    Material material;
    material.radius = 30e-6f * scale;
    material.youngs_modulus = 1e8f * scale * scale;
    Parameters parameters = laboratory.parameters(240, 1);
    parameters.gravity *= scale;
    Simulation simulation = laboratory.simulation(modelOf(strands(scale), material), parameters);
    auto motion = [&](double t) {
      Pose pose = nod(t);
      pose.position *= scale;
      return pose;
    };
    laboratory.advance(simulation, 1, motion, {});
    shapes.push_back(shapesOf(simulation));
    for (auto& strand : shapes.back())
      for (Vec3& x : strand) x /= scale;
  }
  return {absoluteCase({"units of length", "change of the motion", "% of L"},
                       difference(shapes[0], shapes[1]), 0, 0.1)};
}

}  // namespace

void addInvarianceExperiments(std::vector<Experiment>& experiments) {
  experiments.push_back({"a straight strand and a helix settle at several time steps and air drags",
                         namesOfRestShape(), restShape});
  experiments.push_back({"the same strands settle with internal damping of 0, 0.002, 0.02 and 0.1 s",
                         namesOfInternalDamping(), internalDamping});
  experiments.push_back({"the same strands in another order", {"order of strands"}, order});
  experiments.push_back({"the same strands in another unit of length, 1/128 m", {"units of length"}, units});
}

}  // namespace strandcast
