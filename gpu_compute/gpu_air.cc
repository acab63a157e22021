#include "gpu_compute/gpu_air.h"

#include <algorithm>

#include "core/error.h"
#include "gl/current.h"
#include "gpu_compute/gpu_air_system.h"
#include "gpu_compute/wind_passes.h"

namespace strandcast {
namespace {

/// A wind grid by itself, in its own context.
class GpuWind final : public Wind {
 public:
  GpuWind(int cells, float cell, Border border) {
    const gl::MakeCurrent current(context_);
    block_.emplace();
    passes_.emplace(cells, cell, border, programs_);
    shapes_ = gpu::zeros<uint32_t>(1);
  }
  ~GpuWind() override {
    try {
      const gl::MakeCurrent current(context_);
      passes_.reset();
      block_.reset();
      shapes_ = {};
      programs_ = {};
    } catch (const Error&) {  // the driver has failed; its objects are gone
    }
  }

  int cells() const override { return passes_->cells(); }
  float cell() const override { return passes_->cell(); }
  Vec3 origin() const override { return passes_->origin(); }
  Ambient& ambient() override { return passes_->ambient(); }
  void centreAt(const Vec3& middle) override {
    const gl::MakeCurrent current(context_);
    const bool moves = passes_->moveTo(middle, block_->settings);
    sendSettings(1);
    if (moves) passes_->carry();
    image_.reset();
  }
  void reset() override {
    const gl::MakeCurrent current(context_);
    passes_->reset(*block_);
    image_.reset();
  }
  void setComponents(const Component& value) override {
    const gl::MakeCurrent current(context_);
    std::vector<float> faces(3 * static_cast<size_t>((cells() + 1) * (cells() + 1) * (cells() + 1)));
    for (int axis = 0; axis < 3; ++axis)
      for (int k = 0; k < cells() + (axis == 2); ++k)
        for (int j = 0; j < cells() + (axis == 1); ++j)
          for (int i = 0; i < cells() + (axis == 0); ++i)
            faces[static_cast<size_t>(passes_->faceAt(axis, i, j, k))] = value(axis, i, j, k);
    sendSettings(1);
    passes_->setFaces(faces);
    image_.reset();
  }
  void clearSolids() override { bodies_.clear(); }
  void addSolids(std::span<const MovingPrimitive> bodies, std::span<const uint32_t> words,
                 double seconds) override {
    const gl::MakeCurrent current(context_);
    bodies_.insert(bodies_.end(), bodies.begin(), bodies.end());
    if (!words.empty()) shapes_ = gl::Buffer(words);
    solids_seconds_ = seconds;
  }
  void setSources(std::span<const WindSource> sources) override {
    passes_->setSources({sources.begin(), sources.end()});
  }
  void advect(double seconds, bool mac_cormack) override {
    const gl::MakeCurrent current(context_);
    sendSettings(seconds);
    passes_->computeDisplacements(mac_cormack);
    gpu::finishPass();
    passes_->advect(mac_cormack);
    image_.reset();
  }
  void diffuse(double seconds, double viscosity) override {
    const gl::MakeCurrent current(context_);
    sendSettings(seconds);
    passes_->diffuse(seconds, viscosity, false);
    image_.reset();
  }
  void exchange(double seconds) override {
    const gl::MakeCurrent current(context_);
    sendSettings(seconds);
    passes_->computeExchange({});
    gpu::finishPass();
    passes_->diffuse(seconds, 0, true);
    image_.reset();
  }
  PressureReport project() override {
    const gl::MakeCurrent current(context_);
    passes_->setBodies(bodies_, block_->settings);
    sendSettings(solids_seconds_);
    passes_->computeSolids(shapes_);
    gpu::finishPass();
    image_.reset();
    return passes_->project();
  }

  Vec3 velocityAt(const Vec3& point) const override {
    return gpu::windAt(image(), cells(), Vec3((point - origin()) / cell()));
  }
  double largestOutflow() override {
    const std::vector<SphereOnGrid> spheres = passes_->spheres();
    const auto masks = [&](int i, int j, int k) {
      return image().masks[static_cast<size_t>(i + cells() * (j + cells() * k))];
    };
    const auto solid = [&](int i, int j, int k) { return (masks(i, j, k) & 64u) != 0; };
    double most = 0;
    for (int k = 0; k < cells(); ++k)
      for (int j = 0; j < cells(); ++j)
        for (int i = 0; i < cells(); ++i) {
          if ((masks(i, j, k) & 63u) == 0) continue;
          double wanted = 0;
          for (const SphereOnGrid& sphere : spheres) wanted += sphere.outflow(i, j, k);
          if (wanted != 0 && !seesBorder(cells(), i, j, k, solid)) wanted = 0;
          most = std::max(most, std::fabs(component(0, i + 1, j, k) - component(0, i, j, k) +
                                          component(1, i, j + 1, k) - component(1, i, j, k) +
                                          component(2, i, j, k + 1) - component(2, i, j, k) - wanted));
        }
    return most;
  }
  double fastest() const override {
    double most = 0;
    for (int axis = 0; axis < 3; ++axis)
      for (int k = 0; k < cells() + (axis == 2); ++k)
        for (int j = 0; j < cells() + (axis == 1); ++j)
          for (int i = 0; i < cells() + (axis == 0); ++i)
            most = std::max(most, std::fabs(component(axis, i, j, k)));
    return most;
  }
  double component(int axis, int i, int j, int k) const override {
    return static_cast<double>(image().faces[static_cast<size_t>(passes_->faceAt(axis, i, j, k))]);
  }

 private:
  void sendSettings(double seconds) {
    passes_->describe(block_->settings, seconds);
    block_->send();
  }
  const gpu::WindPasses::Image& image() const {
    if (!image_) {
      const gl::MakeCurrent current(context_);
      image_ = passes_->download();
    }
    return *image_;
  }

  mutable gl::HeadlessContext context_;
  gpu::ProgramCache programs_;
  std::optional<gpu::AirBlock> block_;
  std::optional<gpu::WindPasses> passes_;
  gl::Buffer shapes_;
  std::vector<MovingPrimitive> bodies_;
  double solids_seconds_ = 1;
  mutable std::optional<gpu::WindPasses::Image> image_;  ///< empty: out of date
};

}  // namespace

AirFactory gpuAir() {
  return {[](std::vector<WindSource> sources) -> std::unique_ptr<AirSystem> {
            for (const WindSource& source : sources) checkWindSource(source, "wind source");
            return std::make_unique<gpu::GpuAirSystem>(std::move(sources));
          },
          [](int cells, float cell, Wind::Border border) -> std::unique_ptr<Wind> {
            const gl::RestoreCurrent restore;  // a new context becomes current
            return std::make_unique<GpuWind>(cells, cell, border);
          }};
}

}  // namespace strandcast
