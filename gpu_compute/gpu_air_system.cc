#include "gpu_compute/gpu_air_system.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "gl/errors.h"
#include "kernels/scalar_float.h"

namespace strandcast::gpu {
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
  PassTimer timer;
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
