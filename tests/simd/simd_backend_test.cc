#include "simd/simd_backend.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "core/error.h"
#include "core/simulation.h"
#include "simd/simd_kernels.h"
#include "tests/conformance/conformance_model.h"

namespace strandcast {
namespace {

uint64_t hashAfter(int steps, std::unique_ptr<Backend> backend) {
  const StrandModel model = awkwardModel(257, 81);
  const std::vector<Pose> bones_end = {movedHead()};
  const Parameters parameters;
  const auto bodies = movingBodies(parameters.time_step);
  backend->load(model, disturbedState(model, 82));
  for (int i = 0; i < steps; ++i) backend->step({&parameters, {}, bones_end, bodies});
  StrandState state;
  backend->download(state);
  return stateHash(state);
}

TEST(SimdBackend, AnyNumberOfThreadsGivesTheSameBits) {
  // Allows the requested number of workers on machines with fewer cores.
  const oneapi::tbb::global_control allow(oneapi::tbb::global_control::max_allowed_parallelism, 4);
  for (const std::string& target : simdTargets()) {
    const uint64_t one = hashAfter(5, makeSimdBackend(1, target));
    for (int threads = 2; threads <= 4; ++threads)
      EXPECT_EQ(hashAfter(5, makeSimdBackend(threads, target)), one)
          << target << ", " << threads << " threads";
    EXPECT_EQ(hashAfter(5, makeSimdBackend(0, target)), one) << target << ", all threads";
  }
}

// Targets with fused multiply-adds and exact division round alike for any number of lanes, as the scalar
// reference does. AVX3 estimates reciprocals.
TEST(SimdBackend, Avx2GivesTheBitsOfTheReference) {
  const std::vector<std::string> targets = simdTargets();
  if (std::find(targets.begin(), targets.end(), "AVX2") == targets.end())
    GTEST_SKIP() << "this machine has no AVX2";
  EXPECT_EQ(hashAfter(3, makeSimdBackend(1, "AVX2")), hashAfter(3, makeReferenceBackend()));
}

// The state after three steps; before each block's step its scratch memory is filled with `left`.
StrandState stateAfter(const simd::SimdTarget& target, float left) {
  const StrandModel model = awkwardModel(65, 85);
  const std::vector<Pose> bones_end = {movedHead()};
  const Parameters parameters;
  const auto bodies = movingBodies(parameters.time_step);
  const StepInput input{&parameters, {}, bones_end, bodies};
  BlockStore<float> store;
  store.load(model, target.kernel.lanes);
  store.prepare(parameters, true);
  store.upload(disturbedState(model, 86));
  std::vector<float, CacheLineAllocator<float>> scratch(blockScratch(store.maxVertices(), store.lanes()));
  for (int step = 0; step < 3; ++step)
    for (size_t block = 0; block < store.blocks(); ++block) {
      std::fill(scratch.begin(), scratch.end(), left);
      target.kernel.step_block(store.block(block, input, scratch.data()), input, scratch.data());
    }
  StrandState state;
  store.download(state);
  return state;
}

// A block of even strands stores three rows of mass data (massRows()); a block with an uneven strand stores
// one per vertex. The result of a strand must not depend on which.
TEST(SimdBackend, AnEvenStrandComesOutAlikeWhateverIsBesideIt) {
  const auto first = [](const std::string& target, float longer) {
    StrandSet strands;
    for (const float tip : {0.0f, longer}) {
      std::vector<Vec3> points;
      for (int i = 0; i < 12; ++i) {
        const double turn = 0.4 * i;
        points.push_back(
            Eigen::Vector3d(0.01 * std::cos(turn), 0.005 * i, 0.01 * std::sin(turn)).cast<float>());
      }
      points.back().y() += tip;
      strands.append(points);
    }
    Simulation simulation(makeStrandModel(strands), {}, Parameters(), makeSimdBackend(1, target));
    for (int i = 0; i < 20; ++i) simulation.step();
    const std::span<const Vec3> guides = simulation.guides().first(12);
    return std::vector<Vec3>(guides.begin(), guides.end());
  };
  for (const std::string& target : simdTargets())
    EXPECT_EQ(first(target, 0), first(target, 0.003f)) << target;
}

// The blocks of a thread share its scratch memory: a block's result must not depend on what the last one
// left.
TEST(SimdBackend, WhatScratchMemoryHeldComesOutNowhere) {
  for (const simd::SimdTarget& target : simd::runnableTargets()) {
    const uint64_t clean = stateHash(stateAfter(target, 0));
    for (const float left : {1e30f, -1e30f, std::numeric_limits<float>::quiet_NaN()})
      EXPECT_EQ(stateHash(stateAfter(target, left)), clean) << target.name << ", " << left;
  }
}

TEST(SimdBackend, ANamedTargetIsTheOneThatRuns) {
  const std::vector<std::string> targets = simdTargets();
  ASSERT_FALSE(targets.empty());
  for (const std::string& target : targets)
    EXPECT_EQ(makeSimdBackend(1, target)->device(), target + ", 1 thread");
  EXPECT_EQ(makeSimdBackend(2)->device(), targets.front() + ", 2 threads") << "the best comes first";
}

TEST(SimdBackend, TwoBackendsKeepTheirOwnTargets) {
  const std::vector<std::string> targets = simdTargets();
  auto best = makeSimdBackend(1, targets.front());
  auto last = makeSimdBackend(1, targets.back());
  EXPECT_EQ(hashAfter(2, std::move(best)), hashAfter(2, makeSimdBackend(1, targets.front())));
  EXPECT_EQ(hashAfter(2, std::move(last)), hashAfter(2, makeSimdBackend(1, targets.back())));
}

TEST(SimdBackend, WhatCannotRunIsAnError) {
  EXPECT_THROW(makeSimdBackend(1, "AVX3_DL"), Error) << "not compiled: Highway would only emulate it";
  EXPECT_THROW(makeSimdBackend(1, "avx2"), Error);
  EXPECT_THROW(makeSimdBackend(-1), Error);
  EXPECT_THROW(makeSimdBackend(1 << 20), Error);
}

TEST(SimdBackend, InfoNamesTheBestTarget) {
  const BackendInfo info = simdBackendInfo();
  EXPECT_EQ(info.name, "simd");
  EXPECT_TRUE(info.available);
  EXPECT_EQ(info.reason, simdTargets().front());
  EXPECT_GT(info.score, referenceBackendInfo().score);
  EXPECT_EQ(info.create(2)->name(), "simd");
}

TEST(SimdBackend, AModelWithoutStrandsStepsToNothing) {
  const StrandModel model;
  auto backend = makeSimdBackend(2);
  backend->load(model, {});
  const Parameters parameters;
  backend->step({&parameters, {}, {}, {}});
  EXPECT_TRUE(backend->guides().empty());
}

}  // namespace
}  // namespace strandcast
