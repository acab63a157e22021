// The rod against exact solutions; and the joints of straight strands, in world vectors, against the joint
// law in material frames.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "core/simulation.h"
#include "kernels/scalar_strands.h"
#include "validation/rest_shapes.h"
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

namespace strandcast::kernels::f64 {
namespace {

class StraightJoint : public testing::Test {
 protected:
  double draw() { return std::uniform_real_distribution<double>(-1, 1)(random_); }
  real3 drawVector() { return makeReal3(draw(), draw(), draw()); }
  // Draws two edges at an angle of up to 90 degrees, their twist-free frames, and their motion in a substep.
  void drawEdges() {
    const real3 root = makeReal3(0, 0, 1);
    inner_ = normalizeOrZero(drawVector());
    outer_ = normalizeOrZero(inner_ + drawVector() * 0.5);
    inner_frame_ = twistFrame(transportTo(makeQuat(0, 0, 0, 1), root, inner_), 0.5 * draw());
    outer_frame_ = transportTo(inner_frame_, inner_, outer_);
    way_in_ = drawVector() * kStep;
    way_ = drawVector() * kStep;
    swing_in_ = alongSurface(way_in_, inner_);
    swing_ = alongSurface(way_, outer_);
  }

  static constexpr double kStep = 1e-5;
  std::mt19937 random_{7};
  real3 inner_, outer_, way_in_, way_, swing_in_, swing_;
  quat inner_frame_, outer_frame_;
};

TEST_F(StraightJoint, BendsAsInFrames) {
  for (int i = 0; i < 100; ++i) {
    drawEdges();
    const real3 strain = rotate(inner_frame_, jointStrain(inner_frame_, outer_frame_));
    EXPECT_LT(length(straightStrain(inner_, outer_) - strain), 1e-12);
  }
  // Near a full fold, where cappedCosine() limits the strain.
  for (const double angle : {2.0, 2.7, 2.8, 3.0, 3.1}) {
    inner_ = makeReal3(0, 0, 1);
    outer_ = makeReal3(std::sin(angle), 0, std::cos(angle));
    const quat folded = makeQuat(0, std::sin(0.5 * angle), 0, std::cos(0.5 * angle));
    const real3 strain = jointStrain(makeQuat(0, 0, 0, 1), folded);
    EXPECT_NEAR(straightStrain(inner_, outer_).y, strain.y, 1e-12) << angle;
  }
}

TEST_F(StraightJoint, SpinsSoThatThereIsNoTwist) {
  for (int i = 0; i < 100; ++i) {
    drawEdges();
    const quat inner = transportTo(inner_frame_, inner_, normalizeOrZero(inner_ + way_in_));
    const quat outer = transportTo(outer_frame_, outer_, normalizeOrZero(outer_ + way_));
    const double spin = straightSpin(inner_, outer_, swing_in_, swing_);
    EXPECT_NEAR(jointStrain(inner, twistFrame(outer, spin)).z, 0, 1e-3 * kStep);
  }
}

TEST_F(StraightJoint, IsDampedAsInFrames) {
  const double bend = 2, ahead = 3;
  for (int i = 0; i < 100; ++i) {
    drawEdges();
    const double spin_in = kStep * draw(), spin = spin_in + straightSpin(inner_, outer_, swing_in_, swing_);
    const real3 strain = jointStrain(inner_frame_, outer_frame_);
    const real3 own_gain =
        gainedStrain(strain, turningOf(inner_frame_, way_in_), turningOf(outer_frame_, way_));
    const real3 by_spin = twistedStrain(strain, spin_in, spin) - strain;
    const real3 damped = makeReal3(own_gain.x + by_spin.x, own_gain.y + by_spin.y, 0) * ahead;

    const real3 world = straightStrain(inner_, outer_);
    const real3 gain = straightGain(world, inner_, outer_, swing_in_, swing_, 0.5 * (spin_in + spin));
    EXPECT_LT(length(cross(inner_, gain) * ahead - rotate(inner_frame_, damped)), 1e-12);

    const double torque = straightTorque(world, gain, bend * ahead);
    EXPECT_NEAR(torque, torqueDifference(strain, strain + damped, bend), 1e-12);

    // In twist balance, the joint also transmits the torque `beyond` of the joints after it.
    const double beyond = draw();
    const real3 excess = makeReal3(strain.x + damped.x, strain.y + damped.y, torque + 2 * beyond);
    const real3 moment = jointMoment(inner_frame_, strain, excess, bend, 1);
    EXPECT_LT(length(straightMoment(world, gain, inner_, bend, bend * ahead, torque, beyond) - moment),
              1e-12);
  }
}

}  // namespace
}  // namespace strandcast::kernels::f64
