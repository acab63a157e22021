#include "gpu_compute/gpu_backend.h"

#include <utility>

#include "core/error.h"
#include "gpu_compute/driver.h"
#include "gpu_compute/gpu_strands.h"

namespace strandcast {
namespace {

constexpr size_t kSmallModelVertices = 8192 * 32;  // see makeGpuBackend(); measured on an H100

/// Has its own context, current only within a call: any thread may call, one at a time, and the caller's
/// current context stays unchanged.
class GpuBackend final : public Backend, public gpu::GpuDevice {
 public:
  explicit GpuBackend(std::optional<size_t> small_model_vertices)
      : small_model_vertices_(small_model_vertices.value_or(kSmallModelVertices)) {}
  ~GpuBackend() override {
    try {
      const gl::MakeCurrent current(context_);
      strands_.reset();
      programs_.reset();
    } catch (const Error&) {  // the driver has failed; its objects are gone
      static_cast<void>(strands_.release());
      static_cast<void>(programs_.release());
    }
  }

  std::string name() const override { return "gpu"; }
  std::string device() const override { return context_.renderer(); }

  void load(const StrandModel& model, const StrandState& state) override {
    const gl::MakeCurrent current(context_);
    strands_.reset();
    strands_ =
        std::make_unique<gpu::GpuStrands>(model, *programs_, small_model_vertices_, context_.software());
    strands_->upload(state);
  }
  void prepare(const Parameters& parameters, bool bodies) override {
    const gl::MakeCurrent current(context_);
    strands_->prepare(parameters, bodies);
  }
  void upload(const StrandState& state) override {
    const gl::MakeCurrent current(context_);
    strands_->upload(state);
  }
  void download(StrandState& state) override {
    const gl::MakeCurrent current(context_);
    strands_->download(state);
  }
  void step(const StepInput& input) override {
    const gl::MakeCurrent current(context_);
    strands_->step(input);
  }
  std::span<const Vec3> guides() override { return guidesOf(0, strands_->vertices()); }
  std::span<const Vec3> guidesOf(size_t first, size_t count) override {
    if (strands_->guidesReady()) return strands_->guidesOf(first, count);
    const gl::MakeCurrent current(context_);
    return strands_->guidesOf(first, count);
  }
  bool mayHaveDiverged() override {
    const gl::MakeCurrent current(context_);
    return strands_->mayHaveDiverged();
  }
  std::span<const PackedRun> packGuides(const GuideGrid& grid, const PackingFrame& frame) override {
    const gl::MakeCurrent current(context_);
    return strands_->packGuides(grid, frame);
  }
  std::optional<double> packSeconds() override { return strands_ ? strands_->packSeconds() : std::nullopt; }
  bool takesAccelerations() const override { return true; }
  void prepareAccelerations() override {
    const gl::MakeCurrent current(context_);
    strands_->prepareAccelerations();
  }
  std::span<const Vec3> velocities() override {
    const gl::MakeCurrent current(context_);
    return strands_->velocities();
  }
  gl::HeadlessContext& context() override { return context_; }
  gpu::ProgramCache& programs() override { return *programs_; }
  gpu::GpuStrands& strands() override { return *strands_; }
  std::optional<double> gpuSeconds() override { return strands_ ? strands_->gpuSeconds() : std::nullopt; }

 private:
  gl::HeadlessContext context_;
  const size_t small_model_vertices_;
  std::unique_ptr<gpu::ProgramCache> programs_ = std::make_unique<gpu::ProgramCache>();
  std::unique_ptr<gpu::GpuStrands> strands_;
};

struct Probe {
  bool available = false, software = false;
  std::string text;
};

const Probe& probe() {
  static const Probe once = [] {
    const gl::RestoreCurrent restore;
    Probe found;
    try {
      const gl::HeadlessContext context;
      found = {true, context.software(), context.renderer()};
      const auto* const version = glGetString(GL_VERSION);
      const std::string fault =
          gpu::driverFault(found.text, version != nullptr ? reinterpret_cast<const char*>(version) : "");
      if (!fault.empty()) found = {false, false, fault};
    } catch (const Error& error) {
      if (gl::chosenDevice()) throw;  // no silent fallback from a device that the user named
      found.text = error.what();
    }
    return found;
  }();
  return once;
}

}  // namespace

std::unique_ptr<Backend> makeGpuBackend(std::optional<size_t> small_model_vertices) {
  const gl::RestoreCurrent restore;  // a new context becomes current
  return std::make_unique<GpuBackend>(small_model_vertices);
}

BackendInfo gpuBackendInfo() {
  // Score: a software renderer runs on the CPU, slower than the simd backend.
  return {"gpu",
          probe().available,
          probe().text,
          probe().software ? 2 : 100,
          [](int) { return makeGpuBackend(); },
          {SolverKind::kGaussSeidel, SolverKind::kRod}};
}

std::vector<GpuListing> gpuList() {
  std::vector<GpuListing> out;
  for (gl::DeviceInfo& device : gl::headlessDevices())
    out.push_back({device.number, std::move(device.renderer), std::move(device.uuid)});
  return out;
}

}  // namespace strandcast
