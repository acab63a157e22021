#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <random>

#include "validation/experiments.h"
#include "validation/specimen.h"

namespace strandcast {
namespace {

constexpr int kStrands = 1000;
constexpr double kSpeed = 10;        // m/s
constexpr double kThickness = 0.01;  // m
constexpr double kTop = 0.04;        // m, top of the plate below the roots
constexpr double kWay = 0.15;        // m, travel; less than the strands reach below the plate's top

constexpr double kTilts[] = {0, 30, 60};  // degrees

std::string nameOf(double tilt) { return fmt::format("plate of 10 mm at 10 m/s, tilt={:g}", tilt); }

// Straight, wavy and curly strands of 20 to 30 cm, hanging from roots in one plane.
StrandModel hangingStrands() {
  std::mt19937 random(7);
  auto number = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  std::vector<StrandPoints> strands;
  for (int s = 0; s < kStrands; ++s) {
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
  for (double way = first; way < kWay;) {
    way += kSpeed * parameters.time_step;
    simulation.setBodyPose(id, pose(way));
    laboratory.advance(simulation, parameters.time_step);
    const Pose back = pose(way).inverse();
    for (size_t s = 0; s < kStrands; ++s) {
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
