#include "gpu_compute/gpu_backend.h"

#include <gtest/gtest.h>

#include <thread>

#include "core/error.h"
#include "core/strand_order.h"
#include "tests/conformance/conformance_model.h"
#ifdef STRANDCAST_TEST_GL
#include "gl/context.h"
#include "gl/current.h"
#endif

namespace strandcast {
namespace {

TEST(GpuBackendInfo, SaysTheDeviceOrTheReason) {
  const BackendInfo info = gpuBackendInfo();
  EXPECT_EQ(info.name, "gpu");
  EXPECT_FALSE(info.reason.empty());
  std::printf("gpu: %s: %s\n", info.available ? "available" : "not available", info.reason.c_str());
  if (!info.available) {
    EXPECT_THROW(info.create(0), Error);
  } else {
    EXPECT_EQ(info.create(0)->device(), info.reason);
  }
  const bool software = info.reason.find("llvmpipe") != std::string::npos;
  EXPECT_TRUE(!info.available || (info.score < 50) == software) << "a software renderer comes after simd";
}

#ifdef STRANDCAST_TEST_GL

class GpuBackend : public testing::Test {
 protected:
  void SetUp() override {
    if (!gpuBackendInfo().available) GTEST_SKIP() << gpuBackendInfo().reason;
    model_ = awkwardModel(33, 101);
    backend_ = makeGpuBackend();
    backend_->load(model_, restState(model_, model_.rest_roots));
  }
  void step(std::span<const MovingPrimitive> bodies = {}, const NearBodyLists* near = nullptr) {
    backend_->step({&parameters_, {}, {}, bodies, {}, nullptr, near});
  }
  // As Simulation lists them.
  NearBodyLists bodiesNear(std::span<const MovingPrimitive> bodies) const {
    std::vector<Box> boxes;
    for (const MovingPrimitive& body : bodies) boxes.push_back(sweptBox(body));
    const Box reach(Eigen::Vector3f::Constant(-2), Eigen::Vector3f::Constant(2));
    NearBodyLists near;
    makeAllPairs()->find(boxes, std::vector<Box>(strandOrder(model_).neighbourhoods(), reach), near);
    return near;
  }

  StrandModel model_;
  Parameters parameters_;
  std::unique_ptr<Backend> backend_;
};

TEST_F(GpuBackend, LeavesTheContextOfItsCallerCurrent) {
  EXPECT_EQ(eglGetCurrentContext(), EGL_NO_CONTEXT) << "and leaves none behind where there was none";
  gl::HeadlessContext callers;
  callers.makeCurrent();
  const EGLContext before = eglGetCurrentContext();
  step();
  EXPECT_EQ(backend_->guides().size(), model_.vertices());
  EXPECT_EQ(eglGetCurrentContext(), before);
  auto another = makeGpuBackend();
  EXPECT_EQ(eglGetCurrentContext(), before);
  another.reset();
  EXPECT_EQ(eglGetCurrentContext(), before);
  gpuBackendInfo();
  EXPECT_EQ(eglGetCurrentContext(), before);
}

TEST_F(GpuBackend, MayBeCalledFromOneThreadAfterAnother) {
  step();
  std::thread([&] {
    step();
    EXPECT_EQ(backend_->guides().size(), model_.vertices());
  }).join();
  step();
  EXPECT_EQ(backend_->guides().size(), model_.vertices());
}

TEST_F(GpuBackend, GuidesAreThoseOfTheNewestStepOfMany) {
  const StrandState from = disturbedState(model_, 102);
  backend_->upload(from);
  for (int i = 0; i < 7; ++i) step();  // more than there are slots, none read in between
  StrandState state;
  const std::span<const Vec3> guides = backend_->guides();
  backend_->download(state);
  ASSERT_EQ(guides.size(), state.positions.size());
  EXPECT_TRUE(std::equal(guides.begin(), guides.end(), state.positions.begin()));
}

// Listed for their neighbourhoods: llvmpipe ends every loop of an invocation after 65,535 rounds of all of
// them together, and looking at 1000 bodies for every vertex takes more.
TEST_F(GpuBackend, TakesMoreBodiesThanBefore) {
  std::vector<MovingPrimitive> bodies = movingBodies(parameters_.time_step);
  step(bodies);
  const ContactPrimitive far{PrimitiveKind::kSphere, Vec3(50, 0, 0), Vec3::UnitY(), 0.1f, 0.3f};
  bodies.resize(1000, moved(far, Pose(), Pose(), parameters_.time_step));
  const StrandState from = disturbedState(model_, 103);
  backend_->upload(from);
  const NearBodyLists near = bodiesNear(bodies);
  EXPECT_LT(near.bodies.size(), near.offsets.size() * 4);
  step(bodies, &near);
  StrandState many, few;
  backend_->download(many);
  backend_->upload(from);
  step(movingBodies(parameters_.time_step));
  backend_->download(few);
  EXPECT_EQ(stateHash(many), stateHash(few)) << "bodies far away change nothing";
}

TEST_F(GpuBackend, LoadsOneModelAfterAnother) {
  for (size_t strands : {5, 0, 65}) {
    model_ = awkwardModel(strands, 104);
    backend_->load(model_, restState(model_, model_.rest_roots));
    EXPECT_EQ(backend_->guides().size(), model_.vertices());
    step();
    EXPECT_EQ(backend_->guides().size(), model_.vertices());
  }
}

// 32-invocation workgroups of 8 short strands each: 600,000 strands are more groups than one axis takes.
TEST_F(GpuBackend, TakesMoreStrandsThanOneAxisOfWorkgroups) {
  StrandSet set;
  for (int s = 0; s < 600'001; ++s)
    set.append(std::vector<Vec3>{Vec3(0.001f * (s % 1000), 0, 0.001f * (s / 1000)),
                                 Vec3(0.001f * (s % 1000), 0.01f, 0)});
  model_ = makeStrandModel(set);
  parameters_.substeps = parameters_.iterations = 1;
  backend_->load(model_, restState(model_, model_.rest_roots));
  step();
  StrandState state;
  backend_->download(state);
  auto reference = makeReferenceBackend();
  reference->load(model_, restState(model_, model_.rest_roots));
  reference->step({&parameters_});
  StrandState expected;
  reference->download(expected);
  for (size_t i : {size_t{1}, state.positions.size() / 2, state.positions.size() - 1})
    EXPECT_LT((state.positions[i] - expected.positions[i]).norm(), 1e-6f);
  double worst = 0;
  for (size_t i = 0; i < state.positions.size(); ++i)
    worst = std::max<double>(worst, (state.positions[i] - expected.positions[i]).norm());
  EXPECT_LT(worst, 1e-6);
}

#endif

}  // namespace
}  // namespace strandcast
