#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/simulation.h"

namespace strandcast {
namespace {

constexpr double kGravity = 9.81;

// Height over reach of a heavy clamped elastica at rest: theta'' = -gamma (1 - s) cos(theta), theta(0) = 0,
// theta'(1) = 0, solved by shooting on theta'(0) with classical Runge-Kutta.
double exactSag(double gamma) {
  double drop = 0, reach = 0;
  auto endCurvature = [&](double first) {
    constexpr int kSteps = 4000;
    const double h = 1.0 / kSteps;
    double theta = 0, curvature = first;
    drop = reach = 0;
    for (int i = 0; i < kSteps; ++i) {
      const double s = i * h;
      auto bend = [&](double at, double angle) { return -gamma * (1 - at) * std::cos(angle); };
      const double k1 = bend(s, theta), l1 = curvature;
      const double k2 = bend(s + h / 2, theta + h / 2 * l1), l2 = curvature + h / 2 * k1;
      const double k3 = bend(s + h / 2, theta + h / 2 * l2), l3 = curvature + h / 2 * k2;
      const double k4 = bend(s + h, theta + h * l3), l4 = curvature + h * k3;
      const double next = theta + h / 6 * (l1 + 2 * l2 + 2 * l3 + l4);
      drop += h * std::sin((theta + next) / 2);
      reach += h * std::cos((theta + next) / 2);
      theta = next;
      curvature += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    }
    return curvature;
  };
  double low = 0, high = gamma;
  for (int i = 0; i < 60; ++i) (endCurvature((low + high) / 2) > 0 ? high : low) = (low + high) / 2;
  return drop / reach;
}

Parameters rodParameters(double rate) {
  Parameters parameters;
  parameters.solver = SolverKind::kRod;
  parameters.time_step = static_cast<float>(1 / rate);
  parameters.substeps = 1;
  parameters.air_drag = 5;
  return parameters;
}

double lengthOfGamma(double gamma) {
  const Material hair;
  const double r = hair.radius;
  return std::cbrt(gamma * hair.youngs_modulus * r * r / (4 * hair.density * kGravity));
}

Simulation cantilever(double length, int edges, const Parameters& parameters) {
  StrandSet set;
  std::vector<Vec3> points;
  for (int i = 0; i <= edges; ++i) points.emplace_back(static_cast<float>(length * i / edges), 0.0f, 0.0f);
  set.append(points);
  return Simulation(makeStrandModel(set), {}, parameters, makeReferenceBackend());
}

TEST(Rod, ACantileverSagsAsTheElasticaDoes) {
  for (const auto& [gamma, limit] :
       {std::pair(1.0, 0.002), std::pair(10.0, 0.002), std::pair(100.0, 0.006)}) {
    const double exact = exactSag(gamma);
    for (const double rate : {360.0, 720.0}) {
      Simulation simulation = cantilever(lengthOfGamma(gamma), 32, rodParameters(rate));
      for (int i = 0; i < 8 * rate; ++i) simulation.step();
      const Vec3 tip = simulation.guides().back();
      EXPECT_NEAR(-tip.y() / tip.x() / exact, 1, limit) << "gamma " << gamma << " at " << rate << " Hz";
    }
  }
}

TEST(Rod, KeepsItsLengthWhateverTheHeadDoes) {
  Parameters parameters = rodParameters(60);
  parameters.substeps = 6;
  Simulation simulation = cantilever(0.25, 31, parameters);
  for (int i = 1; i <= 120; ++i) {
    const auto t = static_cast<float>(i) / 60;
    simulation.setHeadPose({Vec3(0.1f * std::sin(31.4f * t), 0, 0),
                            Quat(Eigen::AngleAxisf(0.8f * std::sin(9 * t), Eigen::Vector3f::UnitZ()))});
    simulation.step();
    EXPECT_LT(simulation.measure().max_stretch, 1e-4) << "step " << i;
  }
}

TEST(Rod, ATwistOfTheRootReachesTheTip) {
  Parameters parameters = rodParameters(360);
  const Vec3 down(0, -0.2f, 0);
  StrandSet set;
  std::vector<Vec3> points;
  for (int i = 0; i <= 31; ++i) points.push_back(down * (static_cast<float>(i) / 31));
  set.append(points);
  Simulation hanging(makeStrandModel(set), {}, parameters, makeReferenceBackend());
  const Quat start = hanging.state().frames[30];
  constexpr double kQuarterTurn = std::numbers::pi / 2;
  for (int i = 1; i <= 3 * 360; ++i) {
    const double angle = kQuarterTurn * std::min(1.0, i / 360.0);
    hanging.setHeadPose(
        {Vec3::Zero(), Quat(Eigen::AngleAxisf(static_cast<float>(angle), Eigen::Vector3f::UnitY()))});
    hanging.step();
  }
  const double turned = hanging.state().frames[30].angularDistance(start);
  EXPECT_NEAR(turned, kQuarterTurn, 0.01 * kQuarterTurn);
}

TEST(Rod, RestsTheSameAtEveryTimeStepAndDrag) {
  std::vector<Vec3> tips;
  for (const double rate : {240.0, 480.0, 960.0}) {
    for (const float drag : {2.0f, 10.0f}) {
      Parameters parameters = rodParameters(rate);
      parameters.air_drag = drag;
      Simulation simulation = cantilever(0.1, 32, parameters);
      for (int i = 0; i < 8 * rate; ++i) simulation.step();
      tips.push_back(simulation.guides().back());
    }
  }
  for (const Vec3& tip : tips) EXPECT_LT((tip - tips[0]).norm(), 0.001f * 0.1f);
}

TEST(Rod, BadMaterialsAreRefused) {
  StrandSet set;
  set.append(std::vector<Vec3>{Vec3(0, 0, 0), Vec3(0, -0.1f, 0)});
  Material material;
  material.radius = 0;
  EXPECT_ANY_THROW(makeStrandModel(set, {material}));
  material = Material();
  material.stiffness_scale.knots = {{1, 1}, {0, 1}};
  EXPECT_ANY_THROW(makeStrandModel(set, {material}));
}

}  // namespace
}  // namespace strandcast
