#include "air/surroundings.h"

#include <algorithm>
#include <cmath>

#include "air/hair_grid.h"
#include "air/wind_grid.h"
#include "core/error.h"
#include "kernels/scalar_float.h"

namespace strandcast {
namespace {

constexpr float kWindBox = 2;        // of the largest edge of the groom's box
constexpr double kAirDensity = 1.2;  // kg/m^3
constexpr size_t kStrandsAtOnce = 64;

template <class Scalar>
class StrandSurroundings final : public Surroundings {
 public:
  StrandSurroundings(const GridPasses<Scalar>& passes, int threads, std::vector<WindSource> sources)
      : passes_(passes), workers_(threads), sources_(std::move(sources)) {}

  void load(const StrandModel& model, const Parameters& parameters) override {
    model_ = model;
    accelerations_.assign(model.vertices(), Vec3::Zero());
    box_ = restBox(model);
    hair_.reset();
    wind_.reset();
    configure(parameters);
  }

  void configure(const Parameters& p) override {
    if (!needsSurroundings(p)) return;
    if (!hair_ || hair_->shape().cells != p.grid_cells) {
      hair_ = std::make_unique<HairGrid<Scalar>>(passes_, workers_, model_, p.grid_cells, box_);
      const size_t samples = hair_->samples().samples.size();
      changes_.assign(4 * samples, Scalar(0));
      winds_.assign(4 * samples, Scalar(0));
    }
    if (p.wind_grid > 0 && (!wind_ || wind_->cells() != p.grid_cells)) {
      const float cell =
          kWindBox * std::max(box_.sizes().maxCoeff(), 1e-3f) / static_cast<float>(p.grid_cells);
      wind_ = std::make_unique<WindGrid<Scalar>>(passes_, workers_, p.grid_cells, cell,
                                                 WindGrid<Scalar>::Border::kOpen);
      wind_->ambient().configure(p);
      wind_->ambient().setTime(time_);
      wind_->centreAt(Vec3(box_.center()));
      wind_->reset();
    } else if (wind_) {
      wind_->ambient().configure(p);
    }
    const double h = static_cast<double>(p.time_step) / p.substeps;
    auto rate = [&](double scale) {
      return static_cast<float>((1 - std::exp(-static_cast<double>(p.air_drag) * scale * h)) / h);
    };
    rate_ = rate(1);
    rates_.clear();
    for (const float scale : model_.air_drag_scale) rates_.push_back(rate(static_cast<double>(scale)));
  }

  void reset() override {
    if (wind_) wind_->reset();
  }

  std::span<const Vec3> step(const StepInput& input, std::span<const Vec3> positions,
                             std::span<const Vec3> velocities) override {
    const Parameters& p = *input.parameters;
    const double dt = p.time_step;
    time_ += dt;
    const Pose head = input.bones_begin.empty() ? Pose{} : input.bones_begin[0];
    hair_->splat(positions, velocities, head);
    forces_ = p.volume_stiffness > 0 || p.hair_friction > 0;
    if (forces_) hair_->findForces(p, dt);
    if (p.wind_grid > 0) {
      wind_->ambient().setTime(time_);
      wind_->centreAt(head.apply(Vec3(box_.center())));
      wind_->clearSolids();
      wind_->addSolids(input.primitives, input.shapes ? input.shapes->words : std::span<const uint32_t>(),
                       dt);
      wind_->advect(dt, p.mac_cormack > 0);
      wind_->diffuse(dt, static_cast<double>(p.air_viscosity));
      HairDrag<Scalar> drag;
      if (p.air_drag > 0 && p.hairs_per_strand > 0)
        drag = {&hair_->shape(), hair_->nodes(), hair_->frame(),
                static_cast<Scalar>(static_cast<double>(p.air_drag) *
                                    static_cast<double>(p.hairs_per_strand) / kAirDensity)};
      wind_->exchange(dt, drag, sources_);
      wind_->project();
    }
    const size_t strands = model_.strands();
    workers_.forEach(static_cast<int>((strands + kStrandsAtOnce - 1) / kStrandsAtOnce), [&](int chunk) {
      const size_t first = static_cast<size_t>(chunk) * kStrandsAtOnce;
      gather(p, first, std::min(strands, first + kStrandsAtOnce), positions);
    });
    return accelerations_;
  }

 private:
  /// Accelerations of strands begin .. end - 1.
  void gather(const Parameters& p, size_t begin, size_t end, std::span<const Vec3> positions) {
    const StrandSamples& samples = hair_->samples();
    const uint32_t first = samples.offsets[begin], last = samples.offsets[end];
    std::fill(accelerations_.begin() + model_.offsets[begin], accelerations_.begin() + model_.offsets[end],
              Vec3::Zero());
    if (forces_) hair_->changes(first, last, changes_.data() + 4 * static_cast<size_t>(first));
    const bool blows = p.wind_grid > 0;
    if (blows) sampleWind(first, last);
    const float per_second = 1 / p.time_step, less = 1 - p.air_drag_along;
    for (size_t n = first; n < last; ++n) {
      const StrandSample& sample = samples.samples[n];
      const Scalar* place = hair_->place(n);
      Vec3 pushed = Vec3::Zero(), air = p.wind;
      if (forces_) pushed = take(changes_.data() + 4 * n) * per_second;
      if (blows) air = take(winds_.data() + 4 * n);
      if (!pushed.allFinite() || !air.allFinite()) continue;  // of a strand that went wrong
      const Vec3 relative = air - take(place + 3), local = air - p.wind;
      const Vec3 chord = positions[sample.vertex + sample.count - 1] - positions[sample.vertex];
      const Vec3 tangent = chord.norm() > 0 ? Vec3(chord.normalized()) : Vec3(Vec3::Zero());
      for (uint32_t i = 0; i < sample.count; ++i) {
        const float rate = rates_.empty() ? rate_ : rates_[sample.vertex + i];
        Vec3 sum = pushed + local * rate;
        if (less > 0) sum -= notFelt(relative, tangent, std::min(rate, per_second), less);
        accelerations_[sample.vertex + i] += samples.vertex_parts[sample.share + i] * sum;
      }
    }
  }
  static Vec3 notFelt(const Vec3& relative, const Vec3& tangent, float rate, float less) {
    using kernels::f32::real3;
    const real3 out = kernels::f32::dragNotFelt(real3{relative.x(), relative.y(), relative.z()},
                                                real3{tangent.x(), tangent.y(), tangent.z()}, rate, less);
    return {out.x, out.y, out.z};
  }
  void sampleWind(size_t first, size_t last) {
    const Vec3 origin = wind_->origin();
    const Scalar per_cell = 1 / static_cast<Scalar>(wind_->cell());
    for (size_t n = first; n < last; ++n)  // the sample's place among cells, where its wind will be
      for (int c = 0; c < 3; ++c)
        winds_[4 * n + c] =
            (hair_->place(n)[6 + c] - static_cast<Scalar>(origin[c])) * per_cell - Scalar(0.5);
    passes_.sample(wind_->shape(), wind_->centres(), winds_.data() + 4 * first, 4, last - first,
                   winds_.data() + 4 * first);
  }
  static Vec3 take(const Scalar* v) {
    return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
  }

  const GridPasses<Scalar>& passes_;
  Workers workers_;
  std::vector<WindSource> sources_;
  StrandModel model_;
  Box box_;  ///< of the groom at rest
  std::unique_ptr<HairGrid<Scalar>> hair_;
  std::unique_ptr<WindGrid<Scalar>> wind_;
  float rate_ = 0;            ///< 1/s, at which a substep draws hair to the air
  std::vector<float> rates_;  ///< the same by vertex, where they differ
  bool forces_ = false;
  double time_ = 0;
  std::vector<Scalar> changes_, winds_;  ///< per sample, 4 numbers each
  std::vector<Vec3> accelerations_;
};

}  // namespace

std::unique_ptr<Surroundings> makeSurroundings(const std::string& backend, int threads,
                                               std::vector<WindSource> sources) {
  for (const WindSource& source : sources) checkWindSource(source, "wind source");
  if (backend == "oracle")
    return std::make_unique<StrandSurroundings<double>>(scalarPasses<double>(), 1, std::move(sources));
  return std::make_unique<StrandSurroundings<float>>(passesOf(backend), backend == "simd" ? threads : 1,
                                                     std::move(sources));
}

const GridPasses<float>& passesOf(const std::string& backend) {
  if (backend == "reference") return scalarPasses<float>();
  if (backend == "simd") return simdPasses();
  throw Error("there is no air for this backend", backend, "choose simd or reference");
}

}  // namespace strandcast
