// One test fixture for every backend and solver: reference, each instruction set of the simd backend that
// this machine has, gpu. This file tests states, pins, bones and invariants of long runs. See also
// one_step_conformance_test.cc and bodies_conformance_test.cc.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>

#include "core/measure.h"
#include "core/simulation.h"
#include "tests/conformance/conformance_fixture.h"
#include "tests/conformance/conformance_model.h"
#include "tests/thorough.h"

namespace strandcast {
namespace {

// Backends allocate the memory of a feature before the first step that needs it. The step must give the same
// bits as if the memory had been there from the start.
TEST_P(Conformance, SettingsThatChangeFindWhatTheyNeed) {
  const StrandModel model = awkwardModel(33, 25);
  const StrandState from = disturbedState(model, 26);
  Parameters plain = parameters_;
  plain.solver = parameters_.solver == SolverKind::kRod ? SolverKind::kGaussSeidel : SolverKind::kRod;
  Parameters all = parameters_;
  all.goal_rate = 5;
  all.damping_time = 0.002f;  // as in the other steps with a goal, to reuse compiled GPU programs
  const auto bodies = movingBodies(all.time_step);
  const StepInput simple{&plain}, rich{&all, {}, {}, bodies};
  const StrandState at_once = stepped(model, from, rich);
  backend_->load(model, from);
  backend_->step(simple);
  backend_->upload(from);
  backend_->step(rich);
  StrandState later;
  backend_->download(later);
  EXPECT_EQ(stateHash(later), stateHash(at_once));
  EXPECT_EQ(later.contacts, at_once.contacts);
}

TEST_P(Conformance, UploadAndDownloadKeepEveryBit) {
  const StrandModel model = awkwardModel(33, 21);
  backend_->load(model, restState(model, model.rest_roots));
  StrandState state = disturbedState(model, 22), back;
  state.velocities[5] = Vec3(-0.0f, 1e-42f, 3e38f);
  backend_->upload(state);
  backend_->download(back);
  EXPECT_EQ(stateHash(back), stateHash(state));
  const std::span<const Vec3> guides = backend_->guides();
  EXPECT_TRUE(std::equal(guides.begin(), guides.end(), state.positions.begin(), state.positions.end()));
}

TEST_P(Conformance, TheSameInputGivesTheSameBits) {
  const StrandModel model = awkwardModel(33, 31);
  const StrandState from = disturbedState(model, 32);
  Parameters parameters = parameters_;
  const std::vector<Pose> bones_end = {movedHead()};
  const auto bodies = movingBodies(parameters.time_step);
  const StepInput input{&parameters, {}, bones_end, bodies};
  const uint64_t first = stateHash(stepped(model, from, input, 3));
  EXPECT_EQ(stateHash(stepped(model, from, input, 3)), first) << "loaded again";
  backend_->upload(from);
  for (int i = 0; i < 3; ++i) backend_->step(input);
  StrandState state;
  backend_->download(state);
  EXPECT_EQ(stateHash(state), first) << "state set again";
  EXPECT_NE(stateHash(from), first);
}

TEST_P(Conformance, StaysFiniteFromDegenerateStates) {
  const StrandModel model = awkwardModel(33, 41);
  const StrandState rest = restState(model, model.rest_roots);
  StrandState coincident = rest, folded = rest;
  for (size_t s = 0; s < model.strands(); ++s) {
    for (uint32_t v = model.offsets[s]; v < model.offsets[s + 1]; ++v) {
      coincident.positions[v] = rest.positions[model.offsets[s]];
      const uint32_t even = model.offsets[s] + (v - model.offsets[s]) % 2;
      folded.positions[v] = rest.positions[even];
    }
  }
  Parameters parameters = parameters_;
  for (const Vec3& gravity : {Vec3(0, -9.81f, 0), Vec3(0, 0, 0)}) {
    parameters.gravity = gravity;
    const auto bodies = movingBodies(parameters.time_step);
    const StepInput input{&parameters, {}, {}, bodies};
    EXPECT_EQ(nonFinite(stepped(model, coincident, input, 10)), 0u) << "coincident, gravity " << gravity.y();
    EXPECT_EQ(nonFinite(stepped(model, folded, input, 10)), 0u) << "folded, gravity " << gravity.y();
    EXPECT_EQ(nonFinite(stepped(model, rest, input, 10)), 0u) << "rest, gravity " << gravity.y();
  }
}

TEST_P(Conformance, ANotANumberStaysInItsStrand) {
  const StrandModel model = awkwardModel(33, 51);
  const StrandState from = disturbedState(model, 52);
  Parameters parameters = parameters_;
  const auto bodies = movingBodies(parameters.time_step);
  const StepInput input{&parameters, {}, {}, bodies};
  const StrandState clean = stepped(model, from, input, 2);
  const size_t ill = 10;  // 31 vertices, free tip
  StrandState poisoned = from;
  poisoned.positions[model.offsets[ill] + 1] = Vec3::Constant(std::numeric_limits<float>::quiet_NaN());
  const StrandState after = stepped(model, poisoned, input, 2);
  EXPECT_GT(nonFinite(after), 0u);
  for (size_t s = 0; s < model.strands(); ++s) {
    if (s == ill) continue;
    for (uint32_t v = model.offsets[s]; v < model.offsets[s + 1]; ++v)
      ASSERT_EQ(after.positions[v], clean.positions[v]) << "strand " << s;
  }
}

TEST_P(Conformance, PinnedVerticesRideOnTheirRoot) {
  const StrandModel model = awkwardModel(33, 61);
  const std::vector<Pose> bones_end = {movedHead()};
  Parameters parameters = parameters_;
  const auto bodies = movingBodies(parameters.time_step);
  const StrandState after = stepped(model, disturbedState(model, 62), {&parameters, {}, bones_end, bodies});
  size_t pinned = 0;
  for (size_t s = 0; s < model.strands(); ++s) {
    for (uint32_t v = model.offsets[s]; v < model.offsets[s + 1]; ++v) {
      if (!model.isPinned(s, v)) continue;
      ++pinned;
      EXPECT_LT((after.positions[v] - bones_end[0].apply(model.restPosition(s, v))).norm(), 1e-6f);
    }
  }
  EXPECT_GT(pinned, model.strands());
}

TEST_P(Conformance, EachRootRidesOnItsOwnOfAsManyBonesAsThereMayBe) {
  constexpr size_t kBones = 65536, kApart = 1900;
  StrandModel model = awkwardModel(33, 65);
  model.bones.resize(kBones, "skin");
  std::vector<Pose> bones_end(kBones);
  for (size_t s = 0; s < model.strands(); ++s) {
    const size_t bone = kBones - 1 - kApart * s;
    model.root_bones.push_back(static_cast<uint16_t>(bone));
    bones_end[bone] = movedBones()[s % 3];
    bones_end[bone].position.y() += 1e-4f * static_cast<float>(s);
  }
  const Parameters parameters = parameters_;
  const StrandState after = stepped(model, disturbedState(model, 66), {&parameters, {}, bones_end});
  for (size_t s = 0; s < model.strands(); ++s)
    for (uint32_t v = model.offsets[s]; v < model.offsets[s + 1]; ++v)
      if (model.isPinned(s, v)) {
        const Vec3 place = bones_end[model.rootBone(s)].apply(model.restPosition(s, v));
        EXPECT_LT((after.positions[v] - place).norm(), 1e-6f) << "strand " << s;
      }
  EXPECT_EQ(nonFinite(after), 0u);
}

TEST_P(Conformance, TiedVerticesGoWithTheirBone) {
  StrandModel model = awkwardModel(33, 63);
  tieToBones(model);
  const std::vector<Pose> bones_end = movedBones();
  ASSERT_EQ(model.bones.size(), 3u);
  const Parameters parameters = parameters_;
  const StrandState after = stepped(model, disturbedState(model, 64), {&parameters, {}, bones_end});
  size_t tied = 0, whole = 0;
  for (size_t s = 0; s < model.strands(); ++s) {
    size_t of_strand = 0;
    for (uint32_t v = model.offsets[s]; v < model.offsets[s + 1]; ++v) {
      if (!model.isBonePinned(s, v)) continue;
      const Vec3 place = bones_end[model.pin_bones[v]].apply(model.restPosition(s, v));
      EXPECT_LT((after.positions[v] - place).norm(), 1e-6f) << "strand " << s;
      ++of_strand;
    }
    tied += of_strand;
    whole += model.rootBone(s) != 0 && model.isPinned(s, model.offsets[s] + 1);
  }
  EXPECT_GT(tied, 10u);
  EXPECT_GT(whole, 3u);
  EXPECT_EQ(nonFinite(after), 0u);
}

// Strands that two pins hold taut, on one bone and on two, with some pinned in the middle too. Tensions start
// far too high and velocities are random. Tests tensionBound() and the tension increments against the oracle.
TEST_P(Conformance, TautStrandsBetweenPinsAgreeWithTheOracle) {
  if (parameters_.solver != SolverKind::kRod) GTEST_SKIP() << "tensions are the rod's";
  constexpr double kTolerance = 3e-4;  // of a strand's length; measured: 9.2e-5 on CPUs, 1.0e-4 on llvmpipe
  constexpr float kLength = 0.25f, kBend = 0.01f;
  constexpr int kCounts[] = {4, 9, 31, 61, 128};
  StrandSet set;
  for (const int vertices : kCounts)
    for (int s = 0; s < 4; ++s) {
      std::vector<Vec3> points = {Vec3(0.1f, 0, 0.01f * static_cast<float>(s))};
      for (int e = 1; e < vertices; ++e) {
        const float turn =
            kBend * static_cast<float>(s) * (2 * static_cast<float>(e) / static_cast<float>(vertices) - 1);
        points.push_back(points.back() +
                         kLength / static_cast<float>(vertices - 1) * Vec3(1, turn, 0.2f).normalized());
      }
      set.append(points);
      set.pinned.resize(set.vertices(), 0);
      set.pinned.back() = 1;
      if (s == 2) set.pinned[set.vertices() - static_cast<size_t>(vertices / 2)] = 1;
    }
  StrandModel model = makeStrandModel(set);
  model.bones = {"head", "clip"};
  for (size_t s = 1; s < model.strands(); s += 4) pinToBone(model, s, 1, 1, "clip");
  std::vector<Pose> bones_end(2);
  bones_end[0] = bones_end[1] = movedBones()[0];
  bones_end[1].position += Vec3(-1e-5f, 0, 0);
  StrandState from = restState(model, model.rest_roots);
  from.tensions.assign(model.vertices(), 1e7f);
  std::mt19937 random(81);
  std::uniform_real_distribution<float> range(-0.1f, 0.1f);
  for (Vec3& velocity : from.velocities) velocity = Vec3(range(random), range(random), range(random));
  const StepInput input{&parameters_, {}, bones_end};
  const double substep = parameters_.time_step / parameters_.substeps;
  const StrandState mine = stepped(model, from, input), truth = oracleStep(model, from, input);
  const std::vector<double> error = errors(model, mine, truth, substep);
  const std::vector<double> sensitivity = sensitivities(model, from, truth, input, substep);
  double worst = 0;
  for (size_t s = 0; s < model.strands(); ++s) {
    worst = std::max(worst, error[s]);
    EXPECT_LT(error[s], kTolerance + kSensitivityFactor * sensitivity[s]) << "strand " << s;
  }
  std::printf("             at most %.1e of a strand's length\n", worst);
}

// The rod keeps its lengths to rounding. gauss_seidel stretches: few Gauss-Seidel sweeps do not make hair
// inextensible. Its bounds are the stretch measured on 16 vertices with 6 iterations in 4 substeps (mean
// 0.052, max 0.26 on every backend) with a margin of about 40 %.
TEST_P(Conformance, InvariantsHoldOver120Steps) {
  StrandSet set;
  std::mt19937 random(71);
  std::uniform_real_distribution<float> range(-1, 1);
  for (int s = 0; s < 61; ++s) {
    const Vec3 out = Vec3(range(random), 0.3f + std::fabs(range(random)), range(random)).normalized();
    std::vector<Vec3> points;
    for (int i = 0; i < 16; ++i) points.push_back(Vec3(0, 1.5f, 0) + out * (0.1f + 0.01f * i));
    set.append(points);
  }
  const StrandModel model = makeStrandModel(set);
  const ContactPrimitive head{PrimitiveKind::kSphere, Vec3(0, 1.5f, 0), Vec3::UnitY(), 0.099f, 0.3f};
  Parameters parameters = parameters_;
  backend_->load(model, restState(model, model.rest_roots));
  std::vector<Pose> begin(1), end(1);
  Measurement worst;
  for (int step = 1; step <= 120; ++step) {
    const float t = static_cast<float>(step) / 60;
    const Quat nod(Eigen::AngleAxisf(0.4f * std::sin(6 * t), Eigen::Vector3f::UnitX()));
    const Vec3 middle(0, 1.5f, 0);
    end[0] = {middle - nod * middle + Vec3(0.05f * std::sin(4 * t), 0, 0), nod};
    const std::vector<MovingPrimitive> bodies = {moved(head, begin[0], end[0], parameters.time_step)};
    backend_->step({&parameters, begin, end, bodies});
    const Measurement now = measure(model, backend_->guides(), bodies);
    worst.mean_stretch = std::max(worst.mean_stretch, now.mean_stretch);
    worst.max_stretch = std::max(worst.max_stretch, now.max_stretch);
    worst.max_penetration = std::max(worst.max_penetration, now.max_penetration);
    worst.non_finite += now.non_finite;
    begin = end;
  }
  std::printf("             stretch mean %.4f max %.4f, penetration %.2e m\n", worst.mean_stretch,
              worst.max_stretch, worst.max_penetration);
  EXPECT_EQ(worst.non_finite, 0u);
  const bool rod = parameters.solver == SolverKind::kRod;
  EXPECT_LT(worst.mean_stretch, rod ? 1e-5 : 0.07);
  EXPECT_LT(worst.max_stretch, rod ? 1e-4 : 0.36);
  EXPECT_LT(worst.max_penetration, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Backends, Conformance, testing::ValuesIn(backendCases()),
                         [](const auto& contestant) { return contestant.param.name; });

}  // namespace
}  // namespace strandcast
