#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "core/backend.h"
#include "core/strand_block.h"
#include "kernels/scalar_strands.h"

namespace strandcast {
namespace kernels::f32 {
#include "core/block_step.inl"
}  // namespace kernels::f32
namespace kernels::f64 {
#include "core/block_step.inl"
}  // namespace kernels::f64

namespace {

void sweep(const BlockView<float>& block, const StepInput& input, float* scratch) {
  kernels::f32::stepBlock(block, input, scratch);
}
void sweep(const BlockView<double>& block, const StepInput& input, double* scratch) {
  kernels::f64::stepBlock(block, input, scratch);
}

/// Steps one strand after another, one number at a time.
template <class Scalar>
class ScalarBackend final : public Backend {
 public:
  ScalarBackend(std::string name, std::string device) : name_(std::move(name)), device_(std::move(device)) {}
  std::string name() const override { return name_; }
  std::string device() const override { return device_; }

  void load(const StrandModel& model, const StrandState& state) override {
    store_.load(model, 1);
    scratch_.resize(blockScratch(store_.maxVertices(), 1));
    guides_.resize(model.vertices());
    upload(state);
  }
  void prepare(const Parameters& parameters, bool bodies) override { store_.prepare(parameters, bodies); }
  void upload(const StrandState& state) override {
    store_.upload(state);
    readGuides();
  }
  void download(StrandState& state) override { store_.download(state); }

  void step(const StepInput& input) override {
    prepare(*input.parameters, !input.primitives.empty());
    for (size_t b = 0; b < store_.blocks(); ++b)
      sweep(store_.block(b, input, scratch_.data()), input, scratch_.data());
    readGuides();
  }
  std::span<const Vec3> guides() override { return guides_; }
  bool takesAccelerations() const override { return true; }
  void prepareAccelerations() override { velocities_.resize(guides_.size()); }
  std::span<const Vec3> velocities() override {
    velocities_.resize(guides_.size());
    for (size_t b = 0; b < store_.blocks(); ++b) store_.readVelocities(b, velocities_);
    return velocities_;
  }

 private:
  void readGuides() {
    for (size_t b = 0; b < store_.blocks(); ++b) store_.readPositions(b, guides_);
  }

  std::string name_, device_;
  BlockStore<Scalar> store_;
  std::vector<Scalar> scratch_;
  std::vector<Vec3> guides_, velocities_;  ///< velocities: empty until prepareAccelerations()
};

}  // namespace

std::unique_ptr<Backend> makeReferenceBackend() {
  return std::make_unique<ScalarBackend<float>>("reference", "float, scalar, 1 thread");
}

std::unique_ptr<Backend> makeOracleBackend() {
  return std::make_unique<ScalarBackend<double>>("oracle", "double, scalar, 1 thread");
}

BackendInfo referenceBackendInfo() {
  return {"reference",
          true,
          "float, scalar, 1 thread",
          1,
          [](int) { return makeReferenceBackend(); },
          {SolverKind::kGaussSeidel, SolverKind::kRod}};
}

}  // namespace strandcast
