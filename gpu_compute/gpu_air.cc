// The air in compute shaders: as a system of the gpu backend, and a wind grid by itself.
#include "gpu_compute/gpu_air.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "air/air_system.h"
#include "air/wind_source.h"
#include "core/backend.h"
#include "core/error.h"
#include "gl/buffer.h"
#include "gl/current.h"
#include "gpu_compute/gpu_strands.h"
#include "gpu_compute/hair_passes.h"
#include "gpu_compute/wind_passes.h"
#include "kernels/scalar_grid.h"

namespace strandcast::gpu {

/// Air system (docs/air.md) in the memory of the gpu backend: wind on a grid and forces between hairs.
/// Neither the state of strands nor accelerations pass through the CPU. Not thread-safe.
class GpuAirSystem final : public AirSystem, public MeasuredPasses {
 public:
  explicit GpuAirSystem(std::vector<WindSource> sources);
  ~GpuAirSystem() override;

  bool isNeeded(const Parameters& parameters) const override;
  /// Throws Error unless `backend` is the gpu backend, or if the grids do not fit the GPU's memory. `backend`
  /// must outlive this.
  void configure(const StrandModel& model, const Parameters& parameters, Backend& backend) override;
  void reset(const Vec3& origin) override;
  void moveOrigin(const Vec3& origin) override;
  void setSources(std::vector<WindSource> sources) override;
  void step(StepInput& input, Backend& backend) override;
  std::span<const Vec3> accelerations() override;

  bool hasDensity() const override { return splatted_; }
  bool hasWind() const override { return has_wind_grid_; }
  Box box() const override;
  float cell() const override;
  AirSample at(const Vec3& point) const override;

  void measure(bool each, int steps) override;
  std::vector<std::pair<std::string, double>> drainTimes() override;
  PressureReport pressure() override;

 private:
  struct Passes;
  struct Image;
  /// Makes the grids that these settings need and `our` lacks, and resets air that did not blow in the last
  /// step. Throws Error, with the grids of `our` unchanged, if they do not fit the GPU's memory.
  void makeGrids(Passes& our, const StrandModel& model, const Parameters& parameters);
  void setOrigin(const Vec3& origin);
  /// Sets sources_ to world_sources_ relative to origin_, and uploads them.
  void placeSources();
  const Image& image() const;
  AirSample atOwn(const Vec3& point) const;

  std::vector<WindSource> world_sources_;
  std::vector<WindSource> sources_;  ///< the same relative to origin_, as are all positions in here
  Vec3 origin_ = Vec3::Zero();
  Box box_;                      ///< of the groom at rest, m
  GpuDevice* device_ = nullptr;  ///< of the backend; null until configured
  std::unique_ptr<Passes> passes_;
  bool splatted_ = false, has_wind_grid_ = false;  ///< in the newest step
  Pose head_;                                      ///< at the start of the newest step
  HeadExtrapolation head_extrapolation_;
  Pose grid_head_;      ///< pose of the hair grid: HeadExtrapolation::ahead()
  double seconds_ = 0;  ///< s, length of the newest step
  Ambient::Progress progress_;
  bool restarts_ = false;  ///< the next step starts from the initial state of the air
  std::vector<Vec3> read_;
  mutable std::unique_ptr<Image> image_;  ///< downloaded grids of the newest step; null until needed
};

/// Velocity in a downloaded wind grid of `cells` per axis, m/s. `place`: from the grid's low corner, in
/// cells.
Vec3 windAt(const WindPasses::Image& image, int cells, const Vec3& place);

namespace {

// Transform from indices of hair nodes to indices of the wind's cell centres.
AirSettings::Rows windOfHair(const HairLayout& layout, const Pose& head, const WindPasses& wind) {
  const Eigen::Matrix3f turn =
      Eigen::Quaternionf(head.rotation).toRotationMatrix() * (layout.cell / wind.cell());
  const Vec3 offset = (head.apply(layout.corner) - wind.origin()) / wind.cell() - Vec3::Constant(0.5f);
  AirSettings::Rows rows;
  for (int r = 0; r < 3; ++r) rows[static_cast<size_t>(r)] = {turn(r, 0), turn(r, 1), turn(r, 2), offset[r]};
  return rows;
}

}  // namespace

struct GpuAirSystem::Passes {
  AirBlock block;
  std::unique_ptr<HairPasses> hair;
  std::unique_ptr<WindPasses> wind;
  std::optional<Ambient> free_wind;  ///< ambient wind, used without a grid
  gl::Buffer turbulence, sources;    ///< of free_wind
  /// Bound in place of buffers that a variant does not read.
  gl::Buffer nothing = zeros<std::array<float, 4>>(16);
  gl::PassTimer timer;
};

struct GpuAirSystem::Image {
  std::optional<WindPasses::Image> wind;
  std::vector<std::array<float, 4>> nodes;
};

GpuAirSystem::GpuAirSystem(std::vector<WindSource> sources)
    : world_sources_(std::move(sources)), sources_(world_sources_) {}

GpuAirSystem::~GpuAirSystem() {
  if (!passes_) return;
  try {
    const gl::MakeCurrent current(device_->context());
    passes_.reset();
  } catch (const Error&) {  // the driver has failed; its objects are gone
    static_cast<void>(passes_.release());
  }
}

bool GpuAirSystem::isNeeded(const Parameters& p) const { return needsExternalForces(p) || !sources_.empty(); }

void GpuAirSystem::configure(const StrandModel& model, const Parameters& p, Backend& backend) {
  device_ = dynamic_cast<GpuDevice*>(&backend);
  if (device_ == nullptr)
    throw Error("air in compute shaders needs the strands on the same GPU", backend.name(),
                "choose --backend gpu");
  const gl::MakeCurrent current(device_->context());
  if (!passes_) box_ = restBox(model);
  std::unique_ptr<Passes> fresh = passes_ ? nullptr : std::make_unique<Passes>();
  Passes& our = fresh ? *fresh : *passes_;
  makeGrids(our, model, p);
  if (fresh) passes_ = std::move(fresh);
  image_.reset();  // it may be of grids that were replaced
  if (p.wind_grid == 0) {
    if (!our.free_wind) our.free_wind.emplace();
    our.free_wind->configure(p);
    our.turbulence = gl::Buffer(our.free_wind->box());
    our.sources = WindPasses::packed(sources_);
  }
  our.block.settings.sources = static_cast<int>(sources_.size());
  std::vector<float> rates;
  for (const float scale : model.air_drag_scale) rates.push_back(p.air_drag * scale);
  our.hair->setRates(rates);
  our.hair->setVolumeTarget(p.volume_target);
}

void GpuAirSystem::makeGrids(Passes& our, const StrandModel& model, const Parameters& p) {
  gl::discardErrors();
  std::unique_ptr<HairPasses> hair;
  std::unique_ptr<WindPasses> wind;
  if (!our.hair || our.hair->layout().cells != p.grid_cells)
    hair = std::make_unique<HairPasses>(model, box_, p.grid_cells, our.block, device_->programs());
  if (p.wind_grid > 0 && (!our.wind || our.wind->cells() != p.grid_cells))
    wind = std::make_unique<WindPasses>(p.grid_cells, windCell(box_, p.grid_cells), Wind::Border::kOpen,
                                        device_->programs());
  if (gl::ranOutOfMemory())
    throw Error("the grids of the air do not fit the GPU's memory",
                fmt::format("grid_cells {}", p.grid_cells), "use fewer cells or --backend simd");
  if (hair) our.hair = std::move(hair);
  if (p.volume_stiffness == 0) our.hair->reset();
  const bool wind_begins = wind != nullptr || (p.wind_grid > 0 && !has_wind_grid_);
  if (wind) our.wind = std::move(wind);
  if (our.wind) our.wind->ambient().configure(p);
  if (our.wind && p.air_drag_along < 1) {
    our.hair->reserveSlip();
    our.wind->reserveSlip();
  }
  if (!wind_begins) return;
  our.wind->ambient().setProgress(progress_);
  static_cast<void>(our.wind->moveTo(Vec3(box_.center()), our.block.settings));
  our.wind->reset(our.block);
  our.wind->setSources(sources_);
}

void GpuAirSystem::reset(const Vec3& origin) {
  restarts_ = true;
  progress_ = {};
  if (origin == origin_) return;
  image_.reset();
  setOrigin(origin);
}

void GpuAirSystem::moveOrigin(const Vec3& origin) {
  const Vec3 way = origin - origin_;
  setOrigin(origin);
  Ambient& ambient = passes_->wind ? passes_->wind->ambient() : *passes_->free_wind;
  ambient.setProgress(progress_);
  ambient.moveOrigin(way);
  progress_ = ambient.progress();
  if (passes_->wind) passes_->wind->moveOrigin(way);
  head_extrapolation_.moveOrigin();
  head_.position -= way;
  grid_head_.position -= way;
}

void GpuAirSystem::setOrigin(const Vec3& origin) {
  origin_ = origin;
  placeSources();
}

void GpuAirSystem::setSources(std::vector<WindSource> sources) {
  world_sources_ = std::move(sources);
  placeSources();
}

void GpuAirSystem::placeSources() {
  sources_ = movedBy(world_sources_, -origin_);
  if (!passes_) return;
  const gl::MakeCurrent current(device_->context());
  if (passes_->wind) passes_->wind->setSources(sources_);
  if (passes_->free_wind) passes_->sources = WindPasses::packed(sources_);
  passes_->block.settings.sources = static_cast<int>(sources_.size());
}

void GpuAirSystem::step(StepInput& input, Backend&) {
  const Parameters& p = *input.parameters;
  const gl::MakeCurrent current(device_->context());
  Passes& our = *passes_;
  GpuStrands& strands = device_->strands();
  HairPasses& hair = *our.hair;
  AirSettings& settings = our.block.settings;
  const double dt = p.time_step;
  image_.reset();
  seconds_ = dt;
  head_ = input.bones_begin.empty() ? Pose{} : input.bones_begin[0];
  const bool crowds = p.volume_stiffness > 0, rubs = p.hair_friction > 0, forces = crowds || rubs;
  const bool on_grid = p.wind_grid > 0, drags = on_grid && p.air_drag > 0 && p.hairs_per_strand > 0;
  const bool slips = drags && p.air_drag_along < 1;
  splatted_ = forces || drags;
  has_wind_grid_ = on_grid;
  Ambient& blown = on_grid ? our.wind->ambient() : *our.free_wind;
  blown.setProgress(progress_);
  if (std::exchange(restarts_, false)) {
    head_extrapolation_.forget();
    hair.reset();
    if (on_grid) our.wind->reset(our.block);
  }
  blown.advance(dt);
  progress_ = blown.progress();
  grid_head_ = head_extrapolation_.ahead(head_, input.bones_end.empty() ? head_ : input.bones_end[0]);
  hair.describe(settings, grid_head_, p, dt);
  settings.uniform_wind = {p.wind.x(), p.wind.y(), p.wind.z(), 1 - p.air_drag_along};
  settings.drag = p.air_drag;
  settings.exchange = static_cast<float>(dt * static_cast<double>(p.air_drag) * hair.meanDrag() *
                                         static_cast<double>(p.hairs_per_strand) / kAirDensity);
  const gl::Buffer* shapes = &our.nothing;
  bool moved = false;
  if (on_grid) {
    moved = our.wind->moveTo(head_.apply(Vec3(box_.center())), settings);
    our.wind->describe(settings, dt);
    settings.wind_of_hair = windOfHair(hair.layout(), grid_head_, *our.wind);
    our.wind->setBodies(input.primitives, settings);
    shapes = &strands.shapes(input.shapes);
  } else {
    const Vec3 mean = blown.mean(), carried = blown.carried();
    settings.ambient_mean = {mean.x(), mean.y(), mean.z(), blown.turbulence()};
    settings.ambient_carried = {carried.x(), carried.y(), carried.z(), blown.boxPlacesPerMetre()};
  }
  our.block.send();
  finishPass();  // for the positions and velocities of the strands' last step
  our.timer.begin();
  if (moved) our.wind->carry();

  // Passes of hair and of air are independent until computeExchange(). Each finishPass() serves both, so that
  // a pass of hair overlaps with one of air on the GPU.
  const HairPasses::Strands where{strands.positions(), strands.velocityBuffer()};
  const bool mac_cormack = p.mac_cormack > 0;
  hair.splat(where, drags);
  our.timer.passed("splat");
  if (on_grid) {
    our.wind->computeDisplacements(mac_cormack);
    our.wind->computeSolids(*shapes);
  }
  finishPass();
  our.timer.passed("displace, solids");
  if (splatted_) hair.computeDensity(drags);
  if (slips) hair.splatSlip(where);
  our.timer.passed("blur");
  if (on_grid) our.wind->advect(mac_cormack);
  finishPass();
  our.timer.passed("advect");
  if (crowds) hair.crowd(where);
  our.timer.passed("crowd");
  const bool exchanges = drags || (on_grid && !sources_.empty());
  if (on_grid && exchanges)
    our.wind->computeExchange(drags ? std::optional(hair.onAir(slips)) : std::nullopt);
  finishPass();
  our.timer.passed("exchange");
  if (forces) hair.computeForces(crowds, rubs);
  our.timer.passed("gradient, friction");
  if (on_grid) our.wind->diffuse(dt, static_cast<double>(p.air_viscosity), exchanges && !slips);
  finishPass();
  if (slips) our.wind->exchangeSlipping();
  our.timer.passed("diffuse, drag");
  if (on_grid) our.wind->projectAhead(our.timer);
  const bool uniform = !on_grid && sources_.empty() && p.gust == 0 && p.turbulence == 0;
  hair.gather(where,
              {forces,
               on_grid   ? HairPasses::Air::kGrid
               : uniform ? HairPasses::Air::kUniform
                         : HairPasses::Air::kFree,
               p.air_drag_along < 1},
              on_grid ? our.wind->centres() : our.nothing, on_grid ? our.nothing : our.turbulence,
              on_grid ? our.nothing : our.sources, strands.accelerations());
  our.timer.passed("to strands");
  our.timer.passed("all");
  input.accelerations = {};
}

std::span<const Vec3> GpuAirSystem::accelerations() {
  const gl::MakeCurrent current(device_->context());
  read_ = device_->strands().downloadAccelerations();
  return read_;
}

float GpuAirSystem::cell() const {
  return has_wind_grid_ ? passes_->wind->cell() : passes_->hair->layout().cell;
}

Box GpuAirSystem::box() const {
  const int cells = passes_->hair->layout().cells;
  const Eigen::Vector3f half = Eigen::Vector3f::Constant(0.5f * cell() * static_cast<float>(cells));
  const Eigen::Vector3f middle = has_wind_grid_ ? Eigen::Vector3f(passes_->wind->origin()) + half
                                                : Eigen::Vector3f(head_.apply(Vec3(box_.center())));
  return Box(middle - half, middle + half).translated(Eigen::Vector3f(origin_));
}

const GpuAirSystem::Image& GpuAirSystem::image() const {
  if (!image_) {
    const gl::MakeCurrent current(device_->context());
    image_ = std::make_unique<Image>();
    if (has_wind_grid_) image_->wind = passes_->wind->download();
    if (splatted_) image_->nodes = passes_->hair->downloadNodes();
  }
  return *image_;
}

Vec3 windAt(const WindPasses::Image& image, int cells, const Vec3& place) {
  using kernels::f32::real3;
  const float last = static_cast<float>(cells - 1);
  const Vec3 at = place - Vec3::Constant(0.5f);
  const auto p = kernels::f32::gridPlace(real3{at.x(), at.y(), at.z()}, real3{last, last, last});
  const size_t y = static_cast<size_t>(cells), z = y * y;
  const size_t first =
      static_cast<size_t>(p.low.x) + y * static_cast<size_t>(p.low.y) + z * static_cast<size_t>(p.low.z);
  Vec3 out;
  for (int c = 0; c < 3; ++c) {
    auto v = [&](size_t n) { return image.centres[first + n][static_cast<size_t>(c)]; };
    out[c] = kernels::f32::interpolated(v(0), v(1), v(y), v(y + 1), v(z), v(z + 1), v(z + y), v(z + y + 1),
                                        p.part);
  }
  return out;
}

AirSample GpuAirSystem::at(const Vec3& point) const { return atOwn(point - origin_); }

AirSample GpuAirSystem::atOwn(const Vec3& point) const {
  AirSample out;
  if (splatted_) {
    const HairLayout& layout = passes_->hair->layout();
    const Vec3 place = (grid_head_.inverse().apply(point) - layout.corner) / layout.cell;
    const Eigen::Array3i node = place.array().round().cast<int>();
    if ((node >= 0).all() && (node < layout.cells).all())
      out.density =
          image().nodes[static_cast<size_t>(node[0] + layout.cells * (node[1] + layout.cells * node[2]))][3];
  }
  if (!has_wind_grid_) return out;
  const WindPasses& wind = *passes_->wind;
  const WindPasses::Image& seen = *image().wind;
  const Vec3 place = (point - wind.origin()) / wind.cell();
  out.wind = windAt(seen, wind.cells(), place);
  int c[3];
  for (int axis = 0; axis < 3; ++axis)
    c[axis] =
        static_cast<int>(std::clamp(std::floor(place[axis]), 0.0f, static_cast<float>(wind.cells() - 1)));
  const auto own = static_cast<size_t>(c[0] + wind.cells() * (c[1] + wind.cells() * c[2]));
  out.solid = (seen.masks[own] & 64u) != 0;
  if (out.solid) return out;
  out.pressure = static_cast<float>(static_cast<double>(seen.pressures[own]) * kAirDensity *
                                    static_cast<double>(wind.cell()) / seconds_);
  float outflow = 0;
  for (int axis = 0; axis < 3; ++axis) {
    auto face = [&](int by) {
      return seen.faces[static_cast<size_t>(wind.faceAt(
          axis, c[0] + (axis == 0 ? by : 0), c[1] + (axis == 1 ? by : 0), c[2] + (axis == 2 ? by : 0)))];
    };
    outflow += face(1) - face(0);
  }
  out.divergence = outflow / wind.cell();
  return out;
}

void GpuAirSystem::measure(bool each, int steps) {
  const gl::MakeCurrent current(device_->context());
  passes_->timer.measure(each, static_cast<size_t>(steps));
}

std::vector<std::pair<std::string, double>> GpuAirSystem::drainTimes() {
  const gl::MakeCurrent current(device_->context());
  return passes_->timer.take();
}

PressureReport GpuAirSystem::pressure() {
  const gl::MakeCurrent current(device_->context());
  return passes_->wind ? passes_->wind->newestPressure() : PressureReport{};
}

}  // namespace strandcast::gpu

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
