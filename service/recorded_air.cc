#include "service/recorded_air.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>

#include "kernels/scalar_grid.h"

namespace strandcast {

AirGrids gridsOf(const AirFields& fields) {
  const Box box = fields.box();
  AirGrids grids;
  grids.cell = fields.cell();
  grids.cells = static_cast<uint32_t>(std::lround(box.sizes().maxCoeff() / grids.cell));
  grids.origin = Vec3(box.min());
  const size_t count = size_t{grids.cells} * grids.cells * grids.cells;
  const auto first = fields.hasDensity() ? GridValue::kDensity : GridValue::kWindX;
  const auto last = fields.hasWind() ? GridValue::kSolid : GridValue::kDensity;
  for (auto which = static_cast<size_t>(first); which <= static_cast<size_t>(last); ++which)
    grids.values[which].resize(count);
  size_t cell = 0;
  for (uint32_t k = 0; k < grids.cells; ++k)
    for (uint32_t j = 0; j < grids.cells; ++j)
      for (uint32_t i = 0; i < grids.cells; ++i, ++cell) {
        const Eigen::Vector3f place(static_cast<float>(i), static_cast<float>(j), static_cast<float>(k));
        const AirSample sample =
            fields.at(grids.origin + grids.cell * Vec3(place + Eigen::Vector3f::Constant(0.5f)));
        const float values[kGridValues] = {
            sample.density,  sample.wind.x(),   sample.wind.y(),           sample.wind.z(),
            sample.pressure, sample.divergence, sample.solid ? 1.0f : 0.0f};
        for (auto which = static_cast<size_t>(first); which <= static_cast<size_t>(last); ++which)
          grids.values[which][cell] = values[which];
      }
  return grids;
}

SimulationObserver gridRecorder(RecordingPublisher& to, uint32_t every) {
  return [&to, every, frame = uint64_t{0}](Simulation& simulation) mutable {
    if (frame++ % every != 0) return;
    AirSystem* const air = airSystem(simulation.externalForces());
    if (air == nullptr || !air->isNeeded(simulation.parameters())) return;
    if (air->hasDensity() || air->hasWind()) to.addGrids(gridsOf(*air));
  };
}

void warnWithoutGrids(const Recorder& recorder) {
  if (recorder.gridFrames() == 0)
    spdlog::warn(
        "no grids were recorded: the simulation has none; --set volume_stiffness=1 adds a hair grid, --set "
        "wind_grid=1 a wind grid");
}

Box RecordedAir::box() const {
  const float edge = grids_.cell * static_cast<float>(grids_.cells);
  return {grids_.origin, Eigen::Vector3f(grids_.origin) + Eigen::Vector3f::Constant(edge)};
}

float RecordedAir::valueAt(GridValue value, size_t cell) const {
  const std::vector<float>& values = grids_.of(value);
  return values.empty() ? 0 : values[cell];
}

float RecordedAir::between(GridValue value, const Vec3& place) const {
  if (grids_.of(value).empty()) return 0;
  using kernels::f32::real3;
  const float last = static_cast<float>(grids_.cells - 1);
  const auto p = kernels::f32::gridPlace(real3{place.x() - 0.5f, place.y() - 0.5f, place.z() - 0.5f},
                                         real3{last, last, last});
  const size_t y = grids_.cells, z = y * y;
  const float* const v = grids_.of(value).data() + static_cast<size_t>(p.low.x) +
                         y * static_cast<size_t>(p.low.y) + z * static_cast<size_t>(p.low.z);
  return kernels::f32::interpolated(v[0], v[1], v[y], v[y + 1], v[z], v[z + 1], v[z + y], v[z + y + 1],
                                    p.part);
}

AirSample RecordedAir::at(const Vec3& point) const {
  AirSample out;
  const Vec3 place = (point - grids_.origin) / grids_.cell;
  const float last = static_cast<float>(grids_.cells - 1);
  size_t cell = 0;
  for (int axis = 2; axis >= 0; --axis)
    cell = cell * grids_.cells + static_cast<size_t>(std::clamp(std::floor(place[axis]), 0.0f, last));
  if (box().contains(point)) out.density = valueAt(GridValue::kDensity, cell);
  out.wind = Vec3(between(GridValue::kWindX, place), between(GridValue::kWindY, place),
                  between(GridValue::kWindZ, place));
  out.solid = valueAt(GridValue::kSolid, cell) > 0.5f;
  out.pressure = valueAt(GridValue::kPressure, cell);
  out.divergence = valueAt(GridValue::kDivergence, cell);
  return out;
}

}  // namespace strandcast
