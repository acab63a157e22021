#include "simd/simd_backend.h"

#include <fmt/format.h>
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include "core/error.h"
#include "core/strand_block.h"
#include "simd/simd_kernels.h"

namespace strandcast {
namespace {

const std::vector<simd::SimdTarget>& targets() {
  static const std::vector<simd::SimdTarget> list = simd::runnableTargets();
  return list;
}

const simd::SimdTarget& chooseTarget(const std::string& name) {
  if (targets().empty())
    throw Error("no instruction set can run", "simd backend", "choose --backend reference");
  if (name.empty()) return targets().front();
  std::string names;
  for (const simd::SimdTarget& target : targets()) {
    if (target.name == name) return target;
    names += (names.empty() ? "" : ", ") + target.name;
  }
  throw Error("the instruction set cannot run here", name, "choose one of " + names);
}

/// Blocks are independent: neither the number of threads nor their order changes the result.
class SimdBackend final : public Backend {
 public:
  SimdBackend(int threads, const simd::SimdTarget& target)
      : target_(target),
        threads_(threads > 0 ? threads : oneapi::tbb::info::default_concurrency()),
        arena_(threads_) {}

  std::string name() const override { return "simd"; }
  std::string device() const override {
    return fmt::format("{}, {} thread{}", target_.name, threads_, threads_ == 1 ? "" : "s");
  }

  void load(const StrandModel& model, const StrandState& state) override {
    store_.load(model, target_.kernel.lanes);
    const size_t needed = blockScratch(store_.maxVertices(), store_.lanes());
    scratch_stride_ = (needed + 15) / 16 * 16;
    scratch_.assign(scratch_stride_ * threads_, 0.0f);
    guides_.resize(model.vertices());
    arena_.initialize();
    upload(state);
  }
  void prepare(const Parameters& parameters, bool bodies) override { store_.prepare(parameters, bodies); }
  void upload(const StrandState& state) override {
    store_.upload(state);
    for (size_t b = 0; b < store_.blocks(); ++b) store_.readPositions(b, guides_);
    velocities_are_newest_ = false;
  }
  void download(StrandState& state) override { store_.download(state); }

  void step(const StepInput& input) override {
    prepare(*input.parameters, !input.primitives.empty());
    velocities_are_newest_ = !input.accelerations.empty();
    if (velocities_are_newest_) velocities_.resize(guides_.size());
    forBlocks([&](size_t begin, size_t end, int thread) {
      stepBlocks(begin, end, input, scratch_.data() + thread * scratch_stride_);
    });
  }
  std::span<const Vec3> guides() override { return guides_; }
  bool takesAccelerations() const override { return true; }
  void prepareAccelerations() override { velocities_.resize(guides_.size()); }
  std::span<const Vec3> velocities() override {
    if (velocities_are_newest_) return velocities_;
    velocities_.resize(guides_.size());
    forBlocks([&](size_t begin, size_t end, int) {
      for (size_t b = begin; b < end; ++b) store_.readVelocities(b, velocities_);
    });
    velocities_are_newest_ = true;
    return velocities_;
  }

 private:
  /// Calls work(begin, end, thread) for disjoint ranges of all blocks, in parallel. `thread`: 0 to threads_ -
  /// 1.
  template <class Work>
  void forBlocks(const Work& work) {
    if (threads_ == 1) return work(0, store_.blocks(), 0);
    arena_.execute([&] {
      oneapi::tbb::parallel_for(
          oneapi::tbb::blocked_range<size_t>(0, store_.blocks()), [&](const auto& range) {
            work(range.begin(), range.end(), oneapi::tbb::this_task_arena::current_thread_index());
          });
    });
  }
  void stepBlocks(size_t begin, size_t end, const StepInput& input, float* scratch) {
    for (size_t b = begin; b < end; ++b) {
      target_.kernel.step_block(store_.block(b, input, scratch), input, scratch);
      store_.readPositions(b, guides_);
      // A caller that gives accelerations reads velocities after the step. Copied here, they are still in
      // cache.
      if (velocities_are_newest_) store_.readVelocities(b, velocities_);
    }
  }

  simd::SimdTarget target_;
  int threads_;
  oneapi::tbb::task_arena arena_;
  BlockStore<float> store_;
  size_t scratch_stride_ = 0;                              ///< floats per thread
  std::vector<float, CacheLineAllocator<float>> scratch_;  ///< threads x scratch_stride_
  std::vector<Vec3> guides_, velocities_;  ///< velocities_: empty until accelerations are used
  bool velocities_are_newest_ = false;     ///< velocities_ is up to date, or will be when the step ends
};

}  // namespace

std::unique_ptr<Backend> makeSimdBackend(int threads, const std::string& target) {
  if (threads < 0 || threads > 4096)
    throw Error("the number of threads is out of range", std::to_string(threads), "give 0 (all) to 4096");
  return std::make_unique<SimdBackend>(threads, chooseTarget(target));
}

std::vector<std::string> simdTargets() {
  std::vector<std::string> names;
  for (const simd::SimdTarget& target : targets()) names.push_back(target.name);
  return names;
}

BackendInfo simdBackendInfo() {
  BackendInfo info{"simd",
                   !targets().empty(),
                   "",
                   50,
                   [](int threads) { return makeSimdBackend(threads); },
                   {SolverKind::kGaussSeidel, SolverKind::kRod}};
  info.reason =
      info.available ? targets().front().name : "no instruction set of this machine was compiled for";
  return info;
}

}  // namespace strandcast
