#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "validation/experiments.h"
#include "validation/specimen.h"

namespace strandcast {
namespace {

constexpr int kEdges = 32;

std::vector<StrandPoints> strands(float scale) {
  std::vector<StrandPoints> list = {straightStrand(0.1, kEdges, Vec3::UnitX()),
                                    helixStrand(0.01, 0.01, 0.2, kEdges)};
  for (StrandPoints& points : list)
    for (Vec3& x : points) x *= scale;
  return list;
}

// The largest distance between vertices, % of the length of the first strand.
double difference(std::span<const Vec3> a, std::span<const Vec3> b) {
  double largest = 0;
  for (size_t v = 0; v < a.size(); ++v) {
    const double distance = (a[v] - b[v]).cast<double>().norm();
    if (!(distance <= largest)) largest = distance;
  }
  return 100 * largest / 0.1;
}

std::vector<Vec3> copyOf(std::span<const Vec3> positions) { return {positions.begin(), positions.end()}; }

constexpr double kRates[] = {120, 240, 480, 960};

std::vector<Case> restShape(const Laboratory& laboratory) {
  std::vector<std::vector<Vec3>> by_rate;
  double by_drag = 0;
  for (const double rate : kRates) {
    Parameters parameters = laboratory.parameters(rate, 5);
    Simulation simulation = laboratory.simulation(modelOf(strands(1)), parameters);
    laboratory.advance(simulation, 10);
    by_rate.push_back(copyOf(simulation.guides()));
    for (const float drag : {0.1f, 10.0f}) {
      parameters.air_drag = drag;
      simulation.setParameters(parameters);
      laboratory.advance(simulation, 2);
      by_drag = std::max(by_drag, difference(by_rate.back(), simulation.guides()));
    }
  }
  double by_step = 0;
  for (const auto& shape : by_rate) by_step = std::max(by_step, difference(by_rate.back(), shape));
  std::vector<Case> cases = {
      absoluteCase({"rest shape over time steps", "largest distance", "% of L"}, by_step, 0, 0.1),
      absoluteCase({"rest shape over air drags", "largest distance", "% of L"}, by_drag, 0, 0.1)};
  cases[0].note = "settled at 1/120, 1/240, 1/480 and 1/960 s, against the last";
  cases[1].note = "settled at 5/s, then 2 s at 0.1/s and 2 s at 10/s, at each of the time steps";
  return cases;
}

Pose nod(double t) {
  const auto phase = static_cast<float>(2 * M_PI * t);
  return {Vec3(0.05f * std::sin(phase), 0, 0),
          Quat(Eigen::AngleAxisf(0.4f * std::sin(phase), Eigen::Vector3f::UnitZ()))};
}

std::vector<Case> order(const Laboratory& laboratory) {
  std::vector<std::vector<Vec3>> shapes;
  for (const bool reversed : {false, true}) {
    std::vector<StrandPoints> list = strands(1);
    list.insert(list.end(), {straightStrand(0.05, 7, Vec3::UnitZ()), arcStrand(30, 0.15, 20)});
    if (reversed) std::reverse(list.begin(), list.end());
    Simulation simulation = laboratory.simulation(modelOf(list), laboratory.parameters(240, 1));
    laboratory.advance(simulation, 1, nod, {});
    std::vector<Vec3> shape;
    for (size_t s = 0; s < list.size(); ++s) {
      const auto strand = strandOf(simulation, reversed ? list.size() - 1 - s : s);
      shape.insert(shape.end(), strand.begin(), strand.end());
    }
    shapes.push_back(shape);
  }
  return {absoluteCase({"order of strands", "largest distance", "% of L"}, difference(shapes[0], shapes[1]),
                       0, 0)};
}

// With every length a hundred times larger, gravity too, and E / rho its square, the motion is the same: as
// if written in centimetres.
std::vector<Case> units(const Laboratory& laboratory) {
  std::vector<std::vector<Vec3>> shapes;
  for (const float scale : {1.0f, 100.0f}) {
    Material material;
    material.radius = 40e-6f * scale;
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
    shapes.push_back(copyOf(simulation.guides()));
    for (Vec3& x : shapes.back()) x /= scale;
  }
  return {absoluteCase({"units of length", "largest distance", "% of L"}, difference(shapes[0], shapes[1]), 0,
                       0.1)};
}

}  // namespace

void addInvarianceExperiments(std::vector<Experiment>& experiments) {
  experiments.push_back({"a straight strand and a helix settle at several time steps and air drags",
                         {"rest shape over time steps", "rest shape over air drags"},
                         restShape});
  experiments.push_back({"the same strands in another order", {"order of strands"}, order});
  experiments.push_back({"the same strands written in centimetres", {"units of length"}, units});
}

}  // namespace strandcast
