// Bodies that cover the roots of strands: vertices near such a root cannot leave the body.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "core/simulation.h"
#include "validation/specimen.h"

namespace strandcast {
namespace {

constexpr float kRooted = 2e-3f;  // m, depth of the roots in the head

ContactPrimitive sphere(float radius) {
  return {PrimitiveKind::kSphere, Vec3::Zero(), Vec3::UnitY(), radius, 0.3f};
}

class CoveredRoots : public testing::TestWithParam<SolverKind> {
 protected:
  Simulation combed(int edges) {
    Parameters parameters;
    parameters.solver = GetParam();
    parameters.air_drag = 5;
    Simulation simulation(headOfHair(40, 0.24, edges, 0), {headBody()}, parameters, makeReferenceBackend());
    run(simulation, 1);
    return simulation;
  }
  static void run(Simulation& simulation, double seconds) {
    const double step = simulation.parameters().time_step;
    for (int i = 0; i * step < seconds; ++i) simulation.step();
  }
  // Moves a body from `begin` to `end` within one second.
  static void move(Simulation& simulation, BodyId body, const Vec3& begin, const Vec3& end) {
    const float step = simulation.parameters().time_step;
    for (float t = step; t < 1 + step / 2; t += step) {
      simulation.setBodyPose(body, {begin + (end - begin) * std::min(t, 1.0f), Quat::Identity()});
      simulation.step();
    }
  }
  static double fastest(Simulation& simulation) {
    double most = 0;
    for (const Vec3& velocity : simulation.state().velocities) most = std::max<double>(most, velocity.norm());
    return most;
  }
  // m, greatest depth of any vertex in the head.
  static double deepestInHead(Simulation& simulation) {
    double deepest = 0;
    for (const Vec3& position : simulation.guides())
      deepest = std::max<double>(deepest, kHeadRadius - position.norm());
    return deepest;
  }
};

TEST_P(CoveredRoots, TheirHairComesToRestAndIsFreeAgain) {
  const Vec3 away(0, 0.25f, 0), over(0, kHeadRadius, 0);
  const bool rod = GetParam() == SolverKind::kRod;
  for (const int edges : rod ? std::vector{12, 31} : std::vector{12}) {
    Simulation simulation = combed(edges);
    const BodyId ball = simulation.addBody({{sphere(0.05f)}, false, false, {away, Quat::Identity()}});
    move(simulation, ball, away, over);
    run(simulation, 3);
    EXPECT_LT(fastest(simulation), 5e-3) << edges;
    EXPECT_LT(deepestInHead(simulation), kRooted + 1e-4) << "the ball lets nobody into the head, " << edges;
    size_t covered = 0;
    for (uint32_t s = 0; s < simulation.model().strands(); ++s) {
      const uint32_t root = simulation.model().offsets[s], tip = simulation.model().offsets[s + 1] - 1;
      covered += (simulation.guides()[root] - over).norm() < 0.045f;
      EXPECT_GT((simulation.guides()[tip] - over).norm(), 0.05f) << "far from the root it holds hair out";
    }
    EXPECT_GE(covered, 3u);
    move(simulation, ball, over, away);
    run(simulation, 3);
    EXPECT_LT(fastest(simulation), 5e-3) << edges;
    EXPECT_LT(simulation.measure().max_penetration, 2e-4) << edges;
  }
}

TEST_P(CoveredRoots, HairInABodyAroundEverythingRests) {
  Simulation simulation = combed(20);
  simulation.addBody({{sphere(1)}});
  run(simulation, 3);
  EXPECT_LT(fastest(simulation), 5e-3);
}

INSTANTIATE_TEST_SUITE_P(Solvers, CoveredRoots, testing::Values(SolverKind::kRod, SolverKind::kGaussSeidel),
                         [](const auto& solver) { return solverName(solver.param); });

}  // namespace
}  // namespace strandcast
