#include "air/air_system.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "air/hair_grid.h"
#include "air/wind_grid.h"
#include "core/error.h"
#include "kernels/scalar_grid.h"

namespace strandcast {
namespace {

using kernels::f32::real3;

constexpr size_t kStrandsAtOnce = 64;
constexpr uint32_t kSamplesAtOnce = 64;

template <class Scalar>
class CpuAirSystem final : public AirSystem {
 public:
  CpuAirSystem(const GridPasses<Scalar>& passes, int threads, std::vector<WindSource> sources)
      : passes_(passes), workers_(threads), world_sources_(std::move(sources)), sources_(world_sources_) {}

  bool isNeeded(const Parameters& p) const override { return needsExternalForces(p) || !sources_.empty(); }

  void configure(const StrandModel& model, const Parameters& p, Backend& backend) override {
    if (offsets_.empty()) {
      offsets_ = model.offsets;
      box_ = restBox(model);
      accelerations_.assign(model.vertices(), Vec3::Zero());
    }
    std::unique_ptr<HairGrid<Scalar>> hair;
    std::unique_ptr<WindGrid<Scalar>> wind;
    if (!hair_ || hair_->shape().cells != p.grid_cells)
      hair = std::make_unique<HairGrid<Scalar>>(passes_, workers_, model, p.grid_cells, box_);
    if (p.wind_grid > 0 && (!wind_ || wind_->cells() != p.grid_cells))
      wind = std::make_unique<WindGrid<Scalar>>(passes_, workers_, p.grid_cells, windCell(box_, p.grid_cells),
                                                Wind::Border::kOpen);
    if (hair) hair_ = std::move(hair);
    if (p.volume_stiffness == 0) hair_->reset();
    const bool wind_begins = wind != nullptr || (p.wind_grid > 0 && !has_wind_grid_);
    if (wind) {
      wind_ = std::move(wind);
      wind_->setSources(sources_);
    }
    if (wind_) wind_->ambient().configure(p);
    if (wind_begins) {
      wind_->ambient().setProgress(progress_);
      wind_->centreAt(Vec3(box_.center()));
      wind_->reset();
    }
    if (p.wind_grid == 0) {
      if (!free_wind_) free_wind_.emplace();
      free_wind_->configure(p);
    }
    if (wind_ && p.air_drag_along < 1) {
      hair_->reserveSlip();
      wind_->reserveSlip();
    }
    rate_ = p.air_drag;
    rates_.clear();
    for (const float scale : model.air_drag_scale) rates_.push_back(p.air_drag * scale);
    backend.prepareAccelerations();
  }

  void reset(const Vec3& origin) override {
    setOrigin(origin);
    progress_ = {};
    if (wind_) {
      wind_->ambient().setProgress(progress_);
      wind_->reset();
    }
    if (hair_) hair_->reset();
    head_extrapolation_.forget();
  }

  void moveOrigin(const Vec3& origin) override {
    const Vec3 way = origin - origin_;
    setOrigin(origin);
    Ambient& ambient = wind_ ? wind_->ambient() : *free_wind_;
    ambient.setProgress(progress_);
    ambient.moveOrigin(way);
    progress_ = ambient.progress();
    if (wind_) wind_->moveOrigin(way);
    hair_->moveOrigin(way);
    head_extrapolation_.moveOrigin();
    head_.position -= way;
  }

  void setSources(std::vector<WindSource> sources) override {
    world_sources_ = std::move(sources);
    placeSources();
  }

  void step(StepInput& input, Backend& backend) override {
    const Parameters& p = *input.parameters;
    const std::span<const Vec3> positions = backend.guides();
    const double dt = p.time_step;
    const Pose head = input.bones_begin.empty() ? Pose{} : input.bones_begin[0];
    head_ = head;
    seconds_ = dt;
    const Pose head_end = input.bones_end.empty() ? head : input.bones_end[0];
    hair_->locate(positions, backend.velocities(), head_extrapolation_.ahead(head, head_end),
                  kernels::f64::extrapolationShare() * dt);
    forces_ = p.volume_stiffness > 0 || p.hair_friction > 0;
    const bool drags = p.wind_grid > 0 && p.air_drag > 0 && p.hairs_per_strand > 0;
    splatted_ = forces_ || drags;
    has_wind_grid_ = p.wind_grid > 0;
    if (splatted_) hair_->splat();
    if (forces_) hair_->computeForces(p, dt);
    Ambient& blown = has_wind_grid_ ? wind_->ambient() : *free_wind_;
    blown.setProgress(progress_);
    blown.advance(dt);
    progress_ = blown.progress();
    if (has_wind_grid_) {
      wind_->centreAt(head.apply(Vec3(box_.center())));
      wind_->clearSolids();
      wind_->addSolids(input.primitives, input.shapes ? input.shapes->words : std::span<const uint32_t>(),
                       dt);
      wind_->advect(dt, p.mac_cormack > 0);
      wind_->diffuse(dt, static_cast<double>(p.air_viscosity));
      HairDrag<Scalar> drag;
      if (drags) {
        hair_->splatDrag();
        drag.shape = &hair_->shape();
        drag.nodes = hair_->dragNodes();
        drag.frame = hair_->frame();
        drag.box = hair_->box();
        drag.rate = static_cast<Scalar>(static_cast<double>(p.air_drag) * hair_->meanDrag() *
                                        static_cast<double>(p.hairs_per_strand) / kAirDensity);
        if (p.air_drag_along < 1) {
          hair_->splatSlip(positions);
          for (size_t part = 0; part < 2; ++part) drag.slip[part] = hair_->slipNodes(part);
          drag.less = static_cast<Scalar>(1 - p.air_drag_along);
        }
      }
      wind_->exchange(dt, drag);
      wind_->project();
    }
    const size_t strands = offsets_.size() - 1;
    workers_.forEach(static_cast<int>((strands + kStrandsAtOnce - 1) / kStrandsAtOnce), [&](int chunk) {
      const size_t first = static_cast<size_t>(chunk) * kStrandsAtOnce;
      gather(p, first, std::min(strands, first + kStrandsAtOnce), positions);
    });
    input.accelerations = accelerations_;
  }

  std::span<const Vec3> accelerations() override { return accelerations_; }

  bool hasDensity() const override { return splatted_; }
  bool hasWind() const override { return has_wind_grid_; }
  float cell() const override { return has_wind_grid_ ? wind_->cell() : hair_->cell(); }
  Box box() const override { return ownBox().translated(origin_); }
  AirSample at(const Vec3& point) const override { return atOwn(point - origin_); }

 private:
  // Positions in private members are relative to origin_, as those of the strands.
  void setOrigin(const Vec3& origin) {
    origin_ = origin;
    placeSources();
  }
  void placeSources() {
    sources_ = movedBy(world_sources_, -origin_);
    if (wind_) wind_->setSources(sources_);
  }
  Box ownBox() const {
    const Eigen::Vector3f half =
        Eigen::Vector3f::Constant(0.5f * cell() * static_cast<float>(hair_->shape().cells));
    if (has_wind_grid_) return {wind_->origin(), Eigen::Vector3f(wind_->origin()) + 2 * half};
    const Eigen::Vector3f middle = head_.apply(Vec3(box_.center()));
    return {middle - half, middle + half};
  }
  AirSample atOwn(const Vec3& point) const {
    AirSample out;
    if (splatted_) out.density = hair_->densityAtPoint(point);
    if (!has_wind_grid_) return out;
    out.wind = wind_->velocityAt(point);
    int cell[3];
    for (int c = 0; c < 3; ++c) {
      const float place = std::floor((point[c] - wind_->origin()[c]) / wind_->cell());
      cell[c] = static_cast<int>(std::clamp(place, 0.0f, static_cast<float>(wind_->cells() - 1)));
    }
    out.solid = wind_->isSolid(cell[0], cell[1], cell[2]);
    if (out.solid) return out;
    out.pressure = static_cast<float>(wind_->pressureAt(cell[0], cell[1], cell[2]) * kAirDensity *
                                      static_cast<double>(wind_->cell()) / seconds_);
    double outflow = 0;
    for (int axis = 0; axis < 3; ++axis)
      outflow += wind_->component(axis, cell[0] + (axis == 0), cell[1] + (axis == 1), cell[2] + (axis == 2)) -
                 wind_->component(axis, cell[0], cell[1], cell[2]);
    out.divergence = static_cast<float>(outflow) / wind_->cell();
    return out;
  }

  /// Computes the accelerations of strands begin .. end - 1.
  void gather(const Parameters& p, size_t begin, size_t end, std::span<const Vec3> positions) {
    const StrandSamples& samples = hair_->samples();
    const uint32_t last = samples.offsets[end];
    std::fill(accelerations_.begin() + offsets_[begin], accelerations_.begin() + offsets_[end], Vec3::Zero());
    const bool on_grid = p.wind_grid > 0;
    const bool uniform = !on_grid && sources_.empty() && p.gust == 0 && p.turbulence == 0;
    const float per_second = 1 / p.time_step, less = 1 - p.air_drag_along;
    alignas(64) Scalar changes[4 * kSamplesAtOnce], winds[4 * kSamplesAtOnce];
    for (uint32_t first = samples.offsets[begin]; first < last; first += kSamplesAtOnce) {
      const uint32_t until = std::min(last, first + kSamplesAtOnce);
      if (forces_) hair_->changes(first, until, changes);
      if (on_grid) sampleWind(first, until, winds);
      for (uint32_t n = first; n < until; ++n) {
        const StrandSample& sample = samples.samples[n];
        Vec3 pushed = Vec3::Zero(), air = p.wind;
        if (forces_) pushed = toVec3(changes + 4 * (n - first)) * per_second;
        if (on_grid)
          air = toVec3(winds + 4 * (n - first));
        else if (!uniform)
          air = freeWindAt(worldPlace(n));
        const Vec3 local = air - p.wind;
        if (!std::isfinite((pushed + air).sum())) continue;  // a strand that diverged
        const float* parts = samples.vertex_parts.data() + sample.share;
        Vec3* out = accelerations_.data() + sample.vertex;
        if (less == 0 && rates_.empty()) {
          const Vec3 sum = pushed + local * rate_;
          for (uint32_t i = 0; i < sample.count; ++i) out[i] += parts[i] * sum;
          continue;
        }
        const Vec3 relative = air - toVec3(hair_->velocity(n));
        const Vec3 chord = positions[sample.vertex + sample.count - 1] - positions[sample.vertex];
        if (!std::isfinite(chord.sum())) continue;
        const real3 tangent = kernels::f32::directionOfPiece({chord.x(), chord.y(), chord.z()});
        for (uint32_t i = 0; i < sample.count; ++i) {
          const float rate = rates_.empty() ? rate_ : rates_[sample.vertex + i];
          Vec3 sum = pushed + local * rate;
          if (less > 0) sum -= slipDrag(relative, tangent, rate, less);
          out[i] += parts[i] * sum;
        }
      }
    }
  }
  static Vec3 slipDrag(const Vec3& relative, const real3& tangent, float rate, float less) {
    const real3 out =
        kernels::f32::slipDragLoss({relative.x(), relative.y(), relative.z()}, tangent, rate, less);
    return {out.x, out.y, out.z};
  }
  /// Wind without a grid, m/s: the ambient wind plus the velocity of every source that reaches the point.
  /// Nothing blocks it.
  Vec3 freeWindAt(const Vec3& point) const {
    Vec3 sum = free_wind_->at(point), blown;
    for (const WindSource& source : sources_)
      if (source.velocityAt(point, blown)) sum += blown;
    return sum;
  }
  Vec3 worldPlace(size_t n) const {
    return {static_cast<float>(hair_->places(kWorldPlace)[n]),
            static_cast<float>(hair_->places(kWorldPlace + 1)[n]),
            static_cast<float>(hair_->places(kWorldPlace + 2)[n])};
  }
  void sampleWind(size_t first, size_t last, Scalar* out) const {
    constexpr size_t kStride = kSamplesAtOnce + 16;
    alignas(64) Scalar places[3 * kStride];
    const Vec3 origin = wind_->origin();
    const Scalar per_cell = 1 / static_cast<Scalar>(wind_->cell());
    for (int c = 0; c < 3; ++c) {
      const Scalar *in = hair_->places(kWorldPlace + c) + first, begin = static_cast<Scalar>(origin[c]);
      for (size_t i = 0; i < kStride; ++i)
        places[static_cast<size_t>(c) * kStride + i] =
            i < last - first ? (in[i] - begin) * per_cell - Scalar(0.5) : Scalar(0);
    }
    passes_.sample(wind_->shape(), wind_->centres(), places, kStride, last - first, out);
  }
  static Vec3 toVec3(const Scalar* v) {
    return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
  }

  const GridPasses<Scalar>& passes_;
  Workers workers_;
  std::vector<WindSource> world_sources_;
  std::vector<WindSource> sources_;  ///< world_sources_ relative to origin_
  Vec3 origin_ = Vec3::Zero();
  std::vector<uint32_t> offsets_;  ///< of the model; empty before the first configure()
  Box box_;                        ///< bounds of the groom at rest, m
  std::unique_ptr<HairGrid<Scalar>> hair_;
  std::unique_ptr<WindGrid<Scalar>> wind_;
  std::optional<Ambient> free_wind_;  ///< ambient wind without a grid
  float rate_ = 0;            ///< 1/s, air_drag: rate at which hair approaches the velocity of the air
  std::vector<float> rates_;  ///< the same per vertex; empty where all are equal
  bool forces_ = false, splatted_ = false, has_wind_grid_ = false;  ///< of the newest step
  Pose head_;                                                       ///< at the start of the newest step
  HeadExtrapolation head_extrapolation_;
  double seconds_ = 0;  ///< length of the newest step
  Ambient::Progress progress_;
  std::vector<Vec3> accelerations_;
};

struct OwnWorkers {
  explicit OwnWorkers(int threads) : workers(threads) {}
  Workers workers;
};
template <class Scalar>
struct FreeWind final : OwnWorkers, WindGrid<Scalar> {
  FreeWind(const GridPasses<Scalar>& passes, int threads, int cells, float cell, Wind::Border border)
      : OwnWorkers(threads), WindGrid<Scalar>(passes, workers, cells, cell, border) {}
};

}  // namespace

AirFactory cpuAir(const std::string& backend, int threads) {
  auto checked = [](std::vector<WindSource>& sources) {
    for (const WindSource& source : sources) checkWindSource(source, "wind source");
    return std::move(sources);
  };
  if (backend == "oracle")
    return {[checked](std::vector<WindSource> sources) {
              return std::make_unique<CpuAirSystem<double>>(scalarPasses<double>(), 1, checked(sources));
            },
            [](int cells, float cell, Wind::Border border) {
              return std::make_unique<FreeWind<double>>(scalarPasses<double>(), 1, cells, cell, border);
            }};
  const GridPasses<float>& passes = passesOf(backend);
  const int used = backend == "reference" ? 1 : threads;
  return {[&passes, used, checked](std::vector<WindSource> sources) {
            return std::make_unique<CpuAirSystem<float>>(passes, used, checked(sources));
          },
          [&passes, used](int cells, float cell, Wind::Border border) {
            return std::make_unique<FreeWind<float>>(passes, used, cells, cell, border);
          }};
}

}  // namespace strandcast
