// Compares kernels/rod.h, in world vectors, with the joint law of kernels/rod.h in material
// frames.
#include <gtest/gtest.h>

#include <random>

#include "kernels/scalar_double.h"

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
