#include "gpu_compute/gpu_backend.h"

#include <gtest/gtest.h>

#include <thread>

#include "core/broad_phase.h"
#include "core/error.h"
#include "tests/conformance/conformance_model.h"
#ifdef STRANDCAST_TEST_GL
#include <cstdlib>
#include <limits>

#include "gl/context.h"
#include "gl/current.h"
#include "gpu_compute/driver.h"
#include "gpu_compute/gpu_strands.h"
#include "tests/expect_error.h"
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

TEST(Subgroups, AreUsedOnlyWhereAWorkgroupIsCertainlyOne) {
  constexpr int kWorkgroup = 32;
  EXPECT_TRUE(gpu::isOneSubgroup({"NVIDIA Corporation", 32, true}, kWorkgroup));
  EXPECT_FALSE(gpu::isOneSubgroup({"NVIDIA Corporation", 32, false}, kWorkgroup)) << "without shuffles";
  EXPECT_FALSE(gpu::isOneSubgroup({"NVIDIA Corporation", 0, false}, kWorkgroup)) << "without the extension";
  EXPECT_FALSE(gpu::isOneSubgroup({"AMD", 64, true}, kWorkgroup)) << "half of each wave would be idle";
  EXPECT_FALSE(gpu::isOneSubgroup({"Intel", 32, true}, kWorkgroup)) << "may be compiled for 8 or 16";
  EXPECT_FALSE(gpu::isOneSubgroup({"Mesa", 32, true}, kWorkgroup)) << "zink, over a device of any size";
  EXPECT_FALSE(gpu::isOneSubgroup({"Mesa/X.org", 8, true}, kWorkgroup)) << "llvmpipe";
}

TEST(DriverFaults, OldZinkIsRefusedAndSaysWhatToDo) {
  const std::string lavapipe = "zink (llvmpipe (LLVM 15.0.6, 256 bits))";
  const std::string fault = gpu::driverFault(lavapipe, "4.6 (Core Profile) Mesa 22.3.6");
  EXPECT_NE(fault.find("Mesa 22.3.6"), std::string::npos) << fault;
  EXPECT_NE(fault.find(gpu::kUntestedVariable), std::string::npos) << fault;
  EXPECT_NE(
      gpu::driverFault("zink Vulkan 1.3(AMD Radeon RX 6800 (RADV NAVI21))", "4.6 (Core Profile) Mesa 24.2.1"),
      "");
  EXPECT_NE(gpu::driverFault("zink (NVIDIA GeForce)", "4.6"), "") << "of a version that it does not say";
  setenv(gpu::kUntestedVariable, "1", 1);
  EXPECT_EQ(gpu::driverFault(lavapipe, "4.6 (Core Profile) Mesa 22.3.6"), "");
  unsetenv(gpu::kUntestedVariable);
}

TEST(DriverFaults, OtherDriversAreTaken) {
  EXPECT_EQ(gpu::driverFault("zink Vulkan 1.4(llvmpipe (LLVM 15.0.6, 256 bits) (MESA_LLVMPIPE))",
                             "4.6 (Core Profile) Mesa 25.0.7-2~bpo12+1"),
            "");
  EXPECT_EQ(gpu::driverFault("llvmpipe (LLVM 15.0.6, 256 bits)", "4.5 (Core Profile) Mesa 22.3.6"), "");
  EXPECT_EQ(gpu::driverFault("AMD Radeon RX 6800 (radeonsi, navi21)", "4.6 (Core Profile) Mesa 22.3.6"), "");
  EXPECT_EQ(gpu::driverFault("NVIDIA H200/PCIe/SSE2", "4.6.0 NVIDIA 580.159.04"), "");
}

TEST(HeadlessContext, KnowsDriversThatDrawOnTheProcessor) {
  for (const char* renderer : {"llvmpipe (LLVM 15.0.6, 256 bits)", "zink (llvmpipe (LLVM 15.0.6, 256 bits))",
                               "softpipe", "virgl (LLVMPIPE (LLVM 15.0.6, 256 bits))",
                               "D3D12 (Microsoft Basic Render Driver)", "Apple Software Renderer"})
    EXPECT_TRUE(gl::isSoftwareRenderer(renderer)) << renderer;
  for (const char* renderer : {"NVIDIA H200/PCIe/SSE2", "AMD Radeon RX 6800 (radeonsi, navi21)",
                               "Mesa Intel(R) Arc(tm) A770 Graphics (DG2)", "virgl (AMD Radeon)"})
    EXPECT_FALSE(gl::isSoftwareRenderer(renderer)) << renderer;
}

class ChosenDevice : public testing::Test {
 protected:
  void SetUp() override {
    const char* const set = std::getenv(gl::kDeviceVariable);
    if (set != nullptr) before_ = set;
    unsetenv(gl::kDeviceVariable);
  }
  void TearDown() override {
    if (before_.empty())
      unsetenv(gl::kDeviceVariable);
    else
      setenv(gl::kDeviceVariable, before_.c_str(), 1);
  }
  static void choose(const std::string& text) { setenv(gl::kDeviceVariable, text.c_str(), 1); }
  std::string before_;
};

TEST_F(ChosenDevice, IsANumber) {
  EXPECT_EQ(gl::chosenDevice(), std::nullopt);
  choose("");
  EXPECT_EQ(gl::chosenDevice(), std::nullopt);
  choose("0");
  EXPECT_EQ(gl::chosenDevice(), 0);
  choose("15");
  EXPECT_EQ(gl::chosenDevice(), 15);
  for (const char* text : {"-1", "16", "1.5", "1 ", "one", "0x1", "99999999999"}) {
    choose(text);
    const std::string error = errorOf([] { gl::chosenDevice(); });
    EXPECT_NE(error.find(std::string("STRANDCAST_GPU=") + text), std::string::npos) << error;
  }
}

TEST_F(ChosenDevice, EveryOneThatIsListedIsTakenAndNoOther) {
  if (!gl::headlessAvailable(nullptr)) GTEST_SKIP() << "no OpenGL here";
  const std::vector<gl::DeviceInfo> devices = gl::headlessDevices();
  EXPECT_EQ(eglGetCurrentContext(), EGL_NO_CONTEXT) << "listing leaves no context behind";
  size_t taken = 0;
  for (size_t i = 0; i < devices.size(); ++i) {
    EXPECT_EQ(devices[i].number, static_cast<int>(i));
    choose(std::to_string(i));
    const std::string error = errorOf([&] {
      const gl::HeadlessContext context;
      EXPECT_EQ(context.renderer(), devices[i].renderer);
      ++taken;
    });
    if (error.empty()) continue;
    EXPECT_EQ(error, devices[i].renderer) << "the reason is told, and none else is taken";
  }
  EXPECT_EQ(devices.empty(), taken == 0);
  choose(std::to_string(devices.size()));
  const std::string error = errorOf([] { gl::HeadlessContext(); });
  EXPECT_NE(error.find("there is no EGL device " + std::to_string(devices.size())), std::string::npos)
      << error;
}

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
  // Near-body lists as Simulation makes them.
  NearBodyLists bodiesNear(std::span<const MovingPrimitive> bodies) const {
    std::vector<Box> boxes;
    for (const MovingPrimitive& body : bodies) boxes.push_back(sweptBox(body));
    const Box reach(Eigen::Vector3f::Constant(-2), Eigen::Vector3f::Constant(2));
    NearBodyLists near;
    makeAllPairs()->findPairs(boxes, std::vector<Box>(strandOrder(model_).neighbourhoods(), reach), near);
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
  for (int i = 0; i < 7; ++i) step();  // more than the upload ring has slots, without a read
  StrandState state;
  const std::span<const Vec3> guides = backend_->guides();
  backend_->download(state);
  ASSERT_EQ(guides.size(), state.positions.size());
  EXPECT_TRUE(std::equal(guides.begin(), guides.end(), state.positions.begin()));
}

TEST_F(GpuBackend, CopiesTheVerticesThatAreAskedFor) {
  backend_->upload(disturbedState(model_, 105));
  step();
  const std::span<const Vec3> guides = backend_->guides();
  const std::vector<Vec3> before(guides.begin(), guides.end());
  step();
  const size_t first = model_.offsets[3], count = model_.offsets[5] - first;
  const std::span<const Vec3> part = backend_->guidesOf(first, count);
  StrandState state;
  backend_->download(state);
  ASSERT_EQ(part.size(), model_.vertices());
  for (size_t v = 0; v < model_.vertices(); ++v)
    EXPECT_EQ(part[v], v >= first && v < first + count ? state.positions[v] : before[v]) << v;
  const std::span<const Vec3> all = backend_->guides();
  EXPECT_TRUE(std::equal(all.begin(), all.end(), state.positions.begin()));
  EXPECT_EQ(backend_->guidesOf(model_.vertices(), 0).size(), model_.vertices());
}

// The air leaves accelerations in the memory of the guides.
TEST_F(GpuBackend, GuidesOutliveTheMemoryThatAccelerationsTake) {
  backend_->upload(disturbedState(model_, 106));
  step();
  auto& device = dynamic_cast<gpu::GpuDevice&>(*backend_);
  {
    const gl::MakeCurrent current(device.context());
    glClearNamedBufferData(device.strands().accelerations().id(), GL_R32F, GL_RED, GL_FLOAT, nullptr);
  }
  EXPECT_TRUE(backend_->mayHaveDiverged()) << "where it cannot test";
  const std::span<const Vec3> guides = backend_->guides();
  StrandState state;
  backend_->download(state);
  EXPECT_TRUE(std::equal(guides.begin(), guides.end(), state.positions.begin()));
  step();
  EXPECT_FALSE(backend_->mayHaveDiverged());
}

TEST_F(GpuBackend, FindsStrandsThatDiverge) {
  const StrandState sound = restState(model_, model_.rest_roots);
  EXPECT_TRUE(backend_->mayHaveDiverged()) << "what was uploaded is left to the caller";
  step();
  EXPECT_FALSE(backend_->mayHaveDiverged());
  EXPECT_FALSE(backend_->mayHaveDiverged()) << "and says so again";
  for (const size_t s : {size_t{1}, model_.strands() / 2, model_.strands() - 1}) {
    StrandState state = sound;
    state.positions[model_.offsets[s + 1] - 1].y() = std::numeric_limits<float>::quiet_NaN();
    backend_->upload(state);
    step();
    EXPECT_TRUE(backend_->mayHaveDiverged()) << "strand " << s;
  }
  backend_->upload(sound);
  step();
  EXPECT_FALSE(backend_->mayHaveDiverged());
}

// The rod keeps its lengths; a single iteration of gauss_seidel does not pull a tip back over metres.
TEST_F(GpuBackend, FindsStrandsBeyondTheirReach) {
  parameters_.solver = SolverKind::kGaussSeidel;
  parameters_.substeps = parameters_.iterations = 1;
  const std::vector<float> lengths = strandLengths(model_);
  for (const float reach : {1.5f, 1.9f, 2.5f, 6.0f}) {
    StrandState state = restState(model_, model_.rest_roots);
    const uint32_t root = model_.offsets[7], tip = model_.offsets[8] - 1;
    ASSERT_GT(tip, root + 2);
    state.positions[tip] = state.positions[root] + reach * lengths[7] * Vec3::UnitX();
    backend_->upload(state);
    step();
    const bool diverges = backend_->mayHaveDiverged();
    float farthest = 0;  // in lengths
    const std::span<const Vec3> guides = backend_->guides();
    for (size_t s = 0; s < model_.strands(); ++s)
      for (uint32_t v = model_.offsets[s]; v < model_.offsets[s + 1]; ++v)
        if (lengths[s] > 0)
          farthest = std::max(farthest, (guides[v] - guides[model_.offsets[s]]).norm() / lengths[s]);
    EXPECT_EQ(diverges, farthest > kDivergedReach) << reach << " became " << farthest;
  }
}

// Uses near-body lists: llvmpipe ends an invocation's loops after 65,535 iterations in all, and contact
// queries of 1000 bodies for every vertex take more.
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

// llvmpipe does not measure the time of a dispatch: its GL_TIME_ELAPSED is 0.
TEST_F(GpuBackend, ATimeThatTheDriverDoesNotMeasureIsNoneAndNotZero) {
  for (int i = 0; i < 6; ++i) {
    step();
    EXPECT_EQ(backend_->guides().size(), model_.vertices());
  }
  EXPECT_GT(backend_->gpuSeconds().value_or(1), 1e-6);
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

// Workgroups of 32 invocations with 8 short strands each: 600,001 strands exceed the workgroup limit of one
// axis.
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
