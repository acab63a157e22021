#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/simulation.h"
#include "validation/elastica.h"
#include "validation/specimen.h"

namespace strandcast {
namespace {

Parameters rodParameters(double rate) {
  Parameters parameters;
  parameters.solver = SolverKind::kRod;
  parameters.time_step = static_cast<float>(1 / rate);
  parameters.substeps = 1;
  parameters.air_drag = 5;
  return parameters;
}

Simulation cantilever(double length, int edges, const Parameters& parameters) {
  return Simulation(modelOf({straightStrand(length, edges, Vec3::UnitX())}), {}, parameters,
                    makeReferenceBackend());
}

TEST(Rod, ACantileverSagsAsTheElasticaDoes) {
  for (const auto& [gamma, limit] :
       {std::pair(1.0, 0.002), std::pair(10.0, 0.002), std::pair(100.0, 0.006)}) {
    const double exact = restingElastica(gamma, 0).slope();
    for (const double rate : {360.0, 720.0}) {
      Simulation simulation = cantilever(lengthOfGamma(gamma, Material{}), 32, rodParameters(rate));
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

TEST(Rod, HairOfTheMostUnevenDensityComesToRest) {
  std::vector<StrandPoints> strands;
  std::vector<Material> materials;
  for (const auto& [root, tip] : {std::pair(0.1f, 10.0f), std::pair(10.0f, 0.1f)})
    for (const StrandPoints& points :
         {straightStrand(0.1, 31, Vec3::UnitX()), straightStrand(0.3, 31, Vec3(1, 1, 0).normalized()),
          helixStrand(0.01, 0.01, 0.2, 40)}) {
      strands.push_back(points);
      materials.emplace_back().density_scale.knots = {{0, root}, {1, tip}};
      strands.push_back(points);
      materials.emplace_back().density_scale.knots = {{0.5f, root}, {0.5f, tip}};
    }
  Parameters parameters;
  parameters.air_drag = 5;
  Simulation simulation(modelOf(strands, materials), {}, parameters, makeReferenceBackend());
  const int steps = static_cast<int>(10 / parameters.time_step);
  for (int i = 0; i < steps; ++i) simulation.step();
  EXPECT_EQ(simulation.measure().non_finite, 0u);
  EXPECT_LT(simulation.measure().max_stretch, 1e-4);
  const StrandState state = simulation.state();
  for (size_t s = 0; s < strands.size(); ++s) {
    float fastest = 0;
    for (uint32_t v = simulation.model().offsets[s]; v < simulation.model().offsets[s + 1]; ++v)
      fastest = std::max(fastest, state.velocities[v].norm());
    EXPECT_LT(fastest, 1e-3f) << "strand " << s;
  }
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
